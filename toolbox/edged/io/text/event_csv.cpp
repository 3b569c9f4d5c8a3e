// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens and writes plain event files. event_form.cpp detects their form.
#include "edged/io/text/event_csv.hpp"

#include <spdlog/fmt/compile.h>
#include <spdlog/spdlog.h>

#include <iterator>

#include "edged/core/check.hpp"
#include "edged/io/core/geometry.hpp"
#include "edged/io/text/text_dataset.hpp"

namespace edged {
namespace {

TimeUnit stamp_unit(const SourcePath& file, const EventTextForm& form, std::optional<TimeUnit> said) {
  if (said) return *said;
  if (form.unit_known) return form.columns.unit;
  if (const auto guess = guess_time_unit(form.stamps)) return *guess;
  const StampSample& s = form.stamps;
  throw InputError::format(
      "{}: the unit of its stamps is not certain (the first {} events take {:g}, all of them {:g}): give --time-unit "
      "s, "
      "ms, us or ns",
      file.string(), s.count, s.last - s.first, s.end - s.first);
}

class CsvWriter final : public RecordingWriter {
 public:
  explicit CsvWriter(const WriterSetup& setup) : file_(setup.path) {
    const cv::Size sensor = setup.event_sensor();
    file_.write(fmt::format("# geometry {}x{}\nt[s],x,y,p\n", sensor.width, sensor.height));
  }

  void write(const EventBatch& batch) override {
    text_.clear();
    for (const Event& e : batch.events)
      fmt::format_to(std::back_inserter(text_), FMT_COMPILE("{},{},{},{:d}\n"), format_seconds(e.t), e.x, e.y,
                     e.positive);
    file_.write({text_.data(), text_.size()});
  }

  void finish() override { file_.flush(); }

 private:
  OutputFile file_;
  fmt::memory_buffer text_;
};

}  // namespace

Recording open_event_csv(const SourcePath& file, const EventTextForm& form, const Rig* rig,
                         const RecordingOptions& options) {
  if (!form.complaint.empty()) spdlog::warn(form.complaint + " (columns found from the content)");
  const cv::Size size = event_sensor_size(file.string(), options.geometry ? options.geometry : form.geometry, rig);
  TextLayout layout;
  layout.info.name = std::filesystem::path(file.name()).stem().string();
  layout.info.format = "csv";
  layout.info.event_sensor = size;
  EventFile events{file, "events", size.width, size.height, form.columns};
  events.columns.unit = stamp_unit(file, form, options.time_unit);
  layout.events = {std::move(events)};
  return {std::make_unique<TextDataset>(std::move(layout)), std::nullopt};
}

std::unique_ptr<RecordingWriter> write_csv(const WriterSetup& setup) { return std::make_unique<CsvWriter>(setup); }

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes the header and the words of RAW and DAT files.
#include "edged/io/prophesee/raw_writer.hpp"

#include <spdlog/fmt/fmt.h>

#include "edged/core/check.hpp"
#include "edged/io/archive/bytes.hpp"
#include "edged/io/parse/evt_encoder.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

class EvtFileWriter final : public RecordingWriter {
 public:
  EvtFileWriter(const WriterSetup& setup, EvtFormat format)
      : name_(setup.path.string()),
        sensor_(setup.event_sensor()),
        format_(format),
        encoder_(format),
        file_(setup.path) {
    const int most = format == EvtFormat::Dat ? 1 << 14 : 1 << 11;
    if (sensor_.width > most || sensor_.height > most)
      throw InputError::format("{}: the format holds sensors of up to {} x {} px, this one has {} x {}", name_, most,
                               most, sensor_.width, sensor_.height);
  }

  void write(const EventBatch& batch) override {
    if (batch.events.empty()) return;
    if (file_.size() == 0) write_header(batch.events.front().t);
    if (format_ == EvtFormat::Dat) refuse_long_silence(batch.events);
    shifted_ = batch.events;
    for (Event& event : shifted_) event.t -= offset_;
    file_.write(encoder_.encode(shifted_));
  }

  void finish() override {
    if (file_.size() == 0) write_header(Timestamp());
    file_.flush();
  }

 private:
  void write_header(Timestamp first) {
    const unsigned counter_bits = format_ == EvtFormat::Dat ? 32 : 24;
    const std::int64_t offset_us = (to_ns(first) / 1000) >> counter_bits << counter_bits;
    offset_ = std::chrono::microseconds(offset_us);
    std::string text = format_ == EvtFormat::Dat
                           ? fmt::format("% Data file containing CD events.\n% Version 2\n% Height {}\n% Width {}\n",
                                         sensor_.height, sensor_.width)
                           : fmt::format("% evt 3.0\n% format EVT3;height={0};width={1}\n% geometry {1}x{0}\n",
                                         sensor_.height, sensor_.width);
    if (offset_us != 0) text += fmt::format("% {} {}\n", kTimeOffsetKey, offset_us);
    text += format_ == EvtFormat::Dat ? std::string("\x0c\x08") : std::string("% end\n");
    file_.write(text);
  }

  /// A step of more than half the range of the counter would decode as a step backwards.
  void refuse_long_silence(std::span<const Event> events) {
    constexpr Duration kLongest = std::chrono::microseconds(std::int64_t{7} << 28);
    for (const Event& event : events) {
      if (last_ && event.t - *last_ > kLongest)
        throw InputError::format(
            "{}: no events from {} to {} s: DAT cannot hold a silence of more than {:.0f} minutes; take raw", name_,
            format_seconds(*last_), format_seconds(event.t), to_seconds(kLongest) / 60);
      last_ = event.t;
    }
  }

  std::string name_;
  cv::Size sensor_;
  EvtFormat format_;
  EvtEncoder encoder_;
  OutputFile file_;
  Duration offset_{0};
  std::optional<Timestamp> last_;
  std::vector<Event> shifted_;
};

}  // namespace

std::unique_ptr<RecordingWriter> write_raw(const WriterSetup& setup) {
  return std::make_unique<EvtFileWriter>(setup, EvtFormat::Evt3);
}

std::unique_ptr<RecordingWriter> write_dat(const WriterSetup& setup) {
  return std::make_unique<EvtFileWriter>(setup, EvtFormat::Dat);
}

}  // namespace edged

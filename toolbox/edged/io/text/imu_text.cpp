// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/text/imu_text.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/core/measurement_stamps.hpp"
#include "edged/io/stamped_lines.hpp"

namespace edged {
namespace {

StampedLines<ImuSample>::Spec lines_of(const SourcePath& file, const ImuTextForm& form) {
  const std::size_t columns = 1 + std::max({form.t, std::ranges::max(form.gyro), std::ranges::max(form.accel)});
  const auto parse = [form, columns](std::string_view line) -> std::optional<ImuSample> {
    FieldReader fields(line);
    std::optional<Timestamp> t;
    std::vector<double> v(columns);
    for (std::size_t i = 0; i < columns; ++i) {
      const std::string_view field = fields.next();
      if (i == form.t) t = parse_stamp(field, form.unit);
      const auto number = parse_number(field);
      if (!number) return std::nullopt;
      v[i] = *number;
    }
    if (!t) return std::nullopt;
    const auto triple = [&v](const std::array<std::size_t, 3>& at) {
      return Eigen::Vector3d(v[at[0]], v[at[1]], v[at[2]]);
    };
    return ImuSample{*t, form.gyro_scale * triple(form.gyro), form.accel_scale * triple(form.accel)};
  };
  return {file, "imu", form.said, LastLine::MustEnd, parse};
}

/// Batches of events end before the next sample; a sample comes before what has its stamp.
class RecordingWithImu final : public Dataset {
 public:
  RecordingWithImu(std::unique_ptr<Dataset> recording, const SourcePath& file, const ImuTextForm& form)
      : recording_(std::move(recording)), info_(recording_->info()), samples_(lines_of(file, form), repairs_) {
    std::erase_if(info_.streams, [](const StreamInfo& stream) { return stream.role == "imu"; });
    info_.streams.push_back({file.string(), form.said, 0, "imu"});
    info_.has_imu = true;
    check_clock(file, last_stamp(file, lines_of(file, form)));
  }

  const DatasetInfo& info() const override { return info_; }
  void leave_out(Modality unwanted) override { recording_->leave_out(unwanted); }
  std::optional<GroundTruth> ground_truth() const override { return recording_->ground_truth(); }

  std::optional<Measurement> next() override {
    if (!held_) held_ = next_of_recording();
    const ImuSample* sample = samples_.peek();
    if (sample && (!held_ || sample->t <= *first_stamp(*held_))) return samples_.pop();
    auto* batch = held_ ? std::get_if<EventBatch>(&*held_) : nullptr;
    if (batch && sample && batch->events.back().t >= sample->t) {
      const auto cut = std::ranges::lower_bound(batch->events, sample->t, {}, &Event::t);
      EventBatch front{batch->camera, {batch->events.begin(), cut}};
      batch->events.erase(batch->events.begin(), cut);
      return front;
    }
    return std::exchange(held_, std::nullopt);
  }

  std::map<std::string, std::size_t> repairs() const override {
    auto all = recording_->repairs();
    for (const auto& [kind, count] : repairs_.counts()) all[kind] += count;
    return all;
  }

 private:
  static std::optional<Timestamp> last_stamp(const SourcePath& file, const StampedLines<ImuSample>::Spec& lines) {
    return edged::last_stamp(file, [&lines](std::string_view line) {
      const auto sample = lines.parse(line);
      return sample ? std::optional(sample->t) : std::nullopt;
    });
  }

  void check_clock(const SourcePath& file, std::optional<Timestamp> end) {
    const ImuSample* first = samples_.peek();
    if (!first) throw InputError::format("{}: holds no readable IMU sample", file.string());
    if (!info_.begin && (held_ = next_of_recording())) info_.begin = first_stamp(*held_);
    if (!info_.begin) return;
    if ((end && *end < *info_.begin) || (info_.end && first->t > *info_.end))
      throw InputError::format(
          "{}: is on another clock: it holds {} to {} s, the recording {} to {} s; shift the stamps of one of them",
          file.string(), format_seconds(first->t), end ? format_seconds(*end) : "?", format_seconds(*info_.begin),
          info_.end ? format_seconds(*info_.end) : "?");
  }

  /// Without its own IMU.
  std::optional<Measurement> next_of_recording() {
    while (auto measurement = recording_->next())
      if (!std::holds_alternative<ImuSample>(*measurement) && first_stamp(*measurement)) return measurement;
    return std::nullopt;
  }

  std::unique_ptr<Dataset> recording_;
  DatasetInfo info_;
  Repairs repairs_;
  StampedLines<ImuSample> samples_;
  std::optional<Measurement> held_;  ///< the recording's next
};

}  // namespace

std::unique_ptr<Dataset> with_imu_file(std::unique_ptr<Dataset> recording, const SourcePath& file) {
  const ImuTextForm form = find_imu_form(file);
  spdlog::log(form.guessed ? spdlog::level::warn : spdlog::level::info, "{}: {}", file.string(), form.said);
  if (recording->info().has_imu)
    spdlog::warn(fmt::format("{}: its own IMU is left out for {}", recording->info().name, file.string()));
  return std::make_unique<RecordingWithImu>(std::move(recording), file, form);
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording with the samples of a text file among its own measurements. Internal to io.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/dataset.hpp"
#include "edged/io/core/take_before.hpp"
#include "edged/io/parse/stamped_lines.hpp"

namespace edged {

/// Merges the samples into the recording. Batches of events end before the next sample. Of equal stamps, the sample is
/// first. Both must be on one clock: throws InputError if they do not overlap.
template <typename T>
class DatasetWithLines final : public Dataset {
 public:
  /// replaces: the measurements of the recording that the samples replace. info: that of the result.
  DatasetWithLines(std::unique_ptr<Dataset> recording, typename StampedLines<T>::Spec lines, DatasetInfo info,
                   std::function<bool(const Measurement&)> replaces)
      : recording_(std::move(recording)),
        info_(std::move(info)),
        replaces_(std::move(replaces)),
        samples_(lines, repairs_) {
    check_clock(lines);
  }

  const DatasetInfo& info() const override { return info_; }
  void leave_out(Modality unwanted) override { recording_->leave_out(unwanted); }
  std::optional<GroundTruth> ground_truth() const override { return recording_->ground_truth(); }

  std::optional<Measurement> next() override {
    if (!held_) held_ = next_of_recording();
    const T* sample = samples_.peek();
    if (!sample) return std::exchange(held_, std::nullopt);
    if (auto before = take_before(held_, time_of(*sample))) return before;
    return samples_.pop();
  }

  std::map<std::string, std::size_t> repairs() const override {
    auto all = recording_->repairs();
    for (const auto& [kind, count] : repairs_.counts()) all[kind] += count;
    return all;
  }

 private:
  void check_clock(const typename StampedLines<T>::Spec& lines) {
    const T* first = samples_.peek();
    if (!first)
      throw InputError::format("{}: holds no readable line; a line is `{}`", lines.file.string(), lines.layout);
    if (!info_.begin && (held_ = next_of_recording())) info_.begin = first_stamp(*held_);
    if (!info_.begin) return;
    const std::optional<Timestamp> end = last_stamp(lines.file, [&lines](std::string_view line) {
      const auto sample = lines.parse(line);
      return sample ? std::optional(time_of(*sample)) : std::nullopt;
    });
    if ((end && *end < *info_.begin) || (info_.end && time_of(*first) > *info_.end))
      throw InputError::format(
          "{}: is on another clock: it holds {} to {} s, the recording {} to {} s; shift the stamps of one of them",
          lines.file.string(), format_seconds(time_of(*first)), end ? format_seconds(*end) : "?",
          format_seconds(*info_.begin), info_.end ? format_seconds(*info_.end) : "?");
  }

  std::optional<Measurement> next_of_recording() {
    while (auto measurement = recording_->next())
      if (!replaces_(*measurement) && first_stamp(*measurement)) return measurement;
    return std::nullopt;
  }

  std::unique_ptr<Dataset> recording_;
  DatasetInfo info_;
  std::function<bool(const Measurement&)> replaces_;
  Repairs repairs_;
  StampedLines<T> samples_;
  std::optional<Measurement> held_;  ///< the next measurement of the recording
};

}  // namespace edged

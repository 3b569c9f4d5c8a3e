// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/replaced_streams.hpp"

#include <algorithm>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/parse/trajectory_io.hpp"

namespace edged {
namespace {

class WithTruth final : public WrappedDataset {
 public:
  WithTruth(std::unique_ptr<Dataset> recording, Trajectory poses)
      : WrappedDataset(std::move(recording)), truth_{std::move(poses), info().pose_frame} {}

  std::optional<GroundTruth> ground_truth() const override { return truth_; }

 private:
  GroundTruth truth_;
};

class WithImuClock final : public WithSamples {
 public:
  WithImuClock(std::unique_ptr<Dataset> others, std::unique_ptr<Dataset> for_imu, const ImuClock& clock)
      : WithSamples(std::move(others), [](const Measurement& m) { return std::holds_alternative<ImuSample>(m); }),
        imu_(std::move(for_imu)),
        clock_(clock),
        info_(recording_->info()) {
    imu_->leave_out(Modality::Events);
    imu_->leave_out(Modality::Frames);
    if (clock.offset != Duration(0)) move_begin();
  }

  const DatasetInfo& info() const override { return info_; }

 private:
  /// The first stamp was perhaps that of the IMU.
  void move_begin() {
    const Measurement* other = peek_recording();
    std::optional<Timestamp> begin = other ? first_stamp(*other) : std::nullopt;
    if (const auto sample = next_stamp()) begin = begin ? std::min(*begin, *sample) : *sample;
    if (begin && info_.begin && info_.end) *info_.end += *begin - *info_.begin;
    if (begin) info_.begin = begin;
  }

  std::optional<Timestamp> next_stamp() override {
    while (!sample_) {
      const auto measurement = imu_->next();
      if (!measurement) return std::nullopt;
      const auto* sample = std::get_if<ImuSample>(&*measurement);
      if (sample == nullptr) continue;
      if (!line_) line_ = clock_.from(sample->t);
      sample_ = *sample;
      sample_->t = line_->at(sample->t);
    }
    return sample_->t;
  }

  Measurement pop_sample() override { return *std::exchange(sample_, std::nullopt); }

  std::unique_ptr<Dataset> imu_;
  ImuClock clock_;
  DatasetInfo info_;
  std::optional<ClockLine> line_;  ///< from the first sample on
  std::optional<ImuSample> sample_;
};

/// Takes the part of the held measurement before t: all of it, the first events of a batch, or nothing.
std::optional<Measurement> take_before(std::optional<Measurement>& held, Timestamp t) {
  if (!held || *first_stamp(*held) >= t) return std::nullopt;
  auto* batch = std::get_if<EventBatch>(&*held);
  if (batch == nullptr || batch->events.back().t < t) return std::exchange(held, std::nullopt);
  const auto cut = std::ranges::lower_bound(batch->events, t, {}, &Event::t);
  EventBatch front{batch->camera, {batch->events.begin(), cut}};
  batch->events.erase(batch->events.begin(), cut);
  return front;
}

}  // namespace

const Measurement* WithSamples::peek_recording() {
  while (!held_ && (held_ = recording_->next()))
    if (replaced_(*held_) || !first_stamp(*held_)) held_.reset();
  return held_ ? &*held_ : nullptr;
}

std::optional<Measurement> WithSamples::next() {
  peek_recording();
  const auto t = next_stamp();
  if (!t) return std::exchange(held_, std::nullopt);
  if (auto before = take_before(held_, *t)) return before;
  return pop_sample();
}

std::unique_ptr<Dataset> with_truth_file(std::unique_ptr<Dataset> recording, const SourcePath& file) {
  return std::make_unique<WithTruth>(std::move(recording), read_trajectory(file));
}

std::unique_ptr<Dataset> with_imu_clock(std::unique_ptr<Dataset> recording, std::unique_ptr<Dataset> for_imu,
                                        const ImuClock& clock) {
  return std::make_unique<WithImuClock>(std::move(recording), std::move(for_imu), clock);
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Recordings of which a part is replaced: the ground truth, the stamps of the IMU, the samples of one sensor.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "edged/dataset.hpp"
#include "edged/io/archive/source_path.hpp"

namespace edged {

/// The recording with the poses of this file (as read_trajectory reads them, on the recording's clock) as its ground
/// truth, instead of its own. They are of the sensor that the recording's own are of, of the body without any. Throws
/// InputError as read_trajectory().
std::unique_ptr<Dataset> with_truth_file(std::unique_ptr<Dataset> recording, const SourcePath& file);

/// A line from the stamps of an IMU to the clock of the other sensors.
struct ClockLine {
  Timestamp t_imu, t;  ///< a point of it
  double rate = 1.0;   ///< seconds of the IMU per second of the others

  Timestamp at(Timestamp imu) const { return t + duration_from_seconds(to_seconds(imu - t_imu) / rate); }
};

/// What an IMU's clock is relative to that of the other sensors.
struct ImuClock {
  Duration offset{0};
  double rate = 1.0;  ///< seconds of the IMU per second of the others

  /// t_first: the first stamp of the IMU, to which `offset` is added.
  ClockLine from(Timestamp t_first) const { return {t_first, t_first + offset, rate}; }
};

/// The recording with the stamps of its IMU corrected to the clock of the other sensors. The recording is in the order
/// of the wrong stamps, so it is read by two readers at the same time: one for the IMU, one for all else. for_imu: the
/// same recording, opened once more.
std::unique_ptr<Dataset> with_imu_clock(std::unique_ptr<Dataset> recording, std::unique_ptr<Dataset> for_imu,
                                        const ImuClock& clock);

/// A recording that passes all on.
class WrappedDataset : public Dataset {
 public:
  explicit WrappedDataset(std::unique_ptr<Dataset> recording) : recording_(std::move(recording)) {}

  const DatasetInfo& info() const override { return recording_->info(); }
  std::optional<Measurement> next() override { return recording_->next(); }
  void leave_out(Modality unwanted) override { recording_->leave_out(unwanted); }
  std::size_t skip_events(double share) override { return recording_->skip_events(share); }
  std::optional<GroundTruth> ground_truth() const override { return recording_->ground_truth(); }
  std::map<std::string, std::size_t> repairs() const override { return recording_->repairs(); }

 protected:
  std::unique_ptr<Dataset> recording_;
};

/// A recording in which other samples replace some measurements. Batches of events end before the next sample. Of equal
/// stamps, the sample is first.
class WithSamples : public WrappedDataset {
 public:
  std::optional<Measurement> next() final;

 protected:
  using Predicate = std::function<bool(const Measurement&)>;
  /// replaced: true for the measurements of the recording that the samples replace.
  WithSamples(std::unique_ptr<Dataset> recording, Predicate replaced)
      : WrappedDataset(std::move(recording)), replaced_(std::move(replaced)) {}

  /// The stamp of the next sample; nothing after the last one.
  virtual std::optional<Timestamp> next_stamp() = 0;
  virtual Measurement pop_sample() = 0;

  /// The next measurement of the recording that is not replaced, which next() returns later; null at the end.
  const Measurement* peek_recording();

 private:
  Predicate replaced_;
  std::optional<Measurement> held_;
};

}  // namespace edged

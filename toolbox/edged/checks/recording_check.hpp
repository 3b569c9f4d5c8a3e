// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Collects in one pass all that the checks judge: of a whole recording for `edged doctor`, cheaply during a run.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/checks/agreement/accel_axes.hpp"
#include "edged/checks/agreement/event_agreement.hpp"
#include "edged/checks/agreement/external_agreement.hpp"
#include "edged/checks/agreement/stereo_agreement.hpp"
#include "edged/checks/checks.hpp"
#include "edged/dataset.hpp"

namespace edged {

/// What the calibration says.
struct CheckedCalibration {
  std::vector<RigCamera> cameras;  ///< those to check, by their names in the recording
  bool has_extrinsics = true;      ///< their poses are calibrated
  std::optional<ImuNoise> noise = {};
};

/// Compares cameras with the gyro, and counts what all streams contain.
class RecordingCheck {
 public:
  enum class Effort {
    Thorough,
    /// Compares the first camera of each kind until it has rotated enough: with few corners, only during rotation, and
    /// only one of two cameras of the same lens. Most events are only counted. Other cameras are ignored.
    DuringRun
  };

  /// given: nothing without a calibration.
  RecordingCheck(const DatasetInfo& info, std::optional<CheckedCalibration> given, Effort effort);

  /// To be called with each measurement before it is used.
  void add(const Measurement& measurement);

  /// Errors that have become certain since the last call, during a run.
  std::vector<Finding> news();

  /// All findings; during a run warnings and errors. To be called after the last measurement. truth: that of the
  /// dataset. dropped_frames: before add, as in CheckInput.
  std::vector<Finding> findings(const Dataset& dataset, const std::optional<GroundTruth>& truth,
                                bool dropped_frames = false);

  /// True if the gyro confirms the mounting of this camera, which the run has estimated. After findings().
  bool agrees_with(const RigCamera& estimated) const;

 private:
  struct Camera {
    CameraCheck check;
    VisualTurns visual;
    std::size_t counted = 0;  ///< rotations counted so far
    Duration turning{0};      ///< duration of rotation so far
    Duration next_look{0};    ///< duration of rotation at the next comparison
    bool done = false;        ///< comparison finished
    bool deferred = false;    ///< a camera of the same lens is checked instead, unless it has too little data

    const RigCamera& given() const { return check.camera; }
  };

  /// The stamps of one kind of sensor.
  struct StreamSpan {
    std::optional<Timestamp> begin;
    Duration length{0};

    void extend(Timestamp first, Timestamp last) { length = last - *(begin = begin.value_or(first)); }
  };
  /// Which share of the events is counted in detail, so that a burst costs the same at any high rate.
  struct EventThinning {
    Timestamp counted_from = Timestamp::min();
    std::size_t counted = 0, every = 1;  ///< events since then; one of so many is counted in detail

    std::size_t next(const Measurement& measurement);
  };

  bool during_run() const { return effort_ == Effort::DuringRun; }
  void add_imu(std::span<const ImuSample> passed);
  void follow(Camera& camera, const Measurement& measurement);
  void compare(Camera& camera);
  std::vector<Finding> check(const RecordingStatistics& statistics, bool dropped_frames) const;

  Effort effort_;
  std::optional<CheckedCalibration> given_;
  RecordingCollector collector_;
  GyroIntegral gyro_;
  double rate_ = 0.0;  ///< running mean of the gyro rate [rad/s]
  AccelAxes accel_axes_;
  ExternalCheck external_;
  StereoAgreement stereo_;
  EventAgreement event_edges_;
  std::vector<Camera> cameras_;
  StreamSpan imu_, visual_;
  EventThinning thinning_;
  bool look_ = false, looked_ = false;  ///< state of the checks of the IMU
  std::vector<std::string> reported_;
};

}  // namespace edged

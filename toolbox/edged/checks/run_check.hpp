// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Checks during a run whether recording and calibration contradict each other: the cheap part of `edged doctor`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/checks/agreement/accel_axes.hpp"
#include "edged/checks/agreement/stereo_agreement.hpp"
#include "edged/checks/checks.hpp"
#include "edged/dataset.hpp"

namespace edged {

/// Compares the cameras of the mode with the gyro until they have rotated enough. To be cheap, it uses few corners,
/// only during rotation, and only one of two cameras of the same lens. Most events are only counted.
class RunCheck {
 public:
  /// used: the cameras of the run; the first of each kind is checked. has_extrinsics: their poses are calibrated.
  /// noise: as calibrated, if it is.
  RunCheck(const DatasetInfo& info, const Rig& used, bool has_extrinsics, std::optional<ImuNoise> noise = {});

  /// To be called with each measurement before it is used. Those of other cameras are ignored.
  void add(const Measurement& measurement);

  /// Errors that have become certain since the last call.
  std::vector<Finding> news();

  /// Warnings and errors from all measurements. To be called after the last one. truth: that of the dataset.
  /// dropped_frames: before add, as in CheckInput.
  std::vector<Finding> findings(const Dataset& dataset, const std::optional<GroundTruth>& truth,
                                bool dropped_frames = false);

  /// True if the gyro confirms the mounting of this camera, which the run has estimated. After findings().
  bool agrees_with(const RigCamera& estimated) const;

 private:
  struct Camera {
    RigCamera given;
    VisualTurns visual;
    std::size_t counted = 0;  ///< rotations counted so far
    Duration turning{0};      ///< duration of rotation so far
    Duration next_look{0};    ///< duration of rotation at the next comparison
    bool done = false;        ///< comparison finished
    bool same_lens = false;   ///< has the lens of the previous camera
    bool deferred = false;    ///< the previous camera is checked instead, unless it has too little data
    /// Angle to a rotation that fits clearly better than the calibration, if the check of `edged doctor` is
    /// undetermined.
    double contradiction_deg = 0.0;
    std::optional<GyroAgreement> agreement = std::nullopt;
    std::optional<std::string> lens = std::nullopt;  ///< better_lens()
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

  void follow(Camera& camera, const Measurement& measurement);
  void compare(Camera& camera);
  static void check_camera(const Camera& camera, const RecordingStatistics& statistics, Findings& out);
  std::vector<Finding> check(const RecordingStatistics& statistics, bool dropped_frames) const;

  bool has_extrinsics_;
  std::optional<ImuNoise> noise_;
  RecordingCollector collector_;
  GyroIntegral gyro_;
  double rate_ = 0.0;  ///< running mean of the gyro rate [rad/s]
  AccelAxes accel_axes_;
  StereoAgreement stereo_;
  std::vector<Camera> cameras_;
  StreamSpan imu_, visual_;
  EventThinning thinning_;
  bool look_ = false, looked_ = false;  ///< state of the checks of the IMU
  std::vector<std::string> reported_;
};

}  // namespace edged

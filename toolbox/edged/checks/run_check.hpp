// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Checks during a run whether recording and calibration contradict each other: the cheap part of `edged doctor`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/checks/agreement/accel_axes.hpp"
#include "edged/checks/diagnosis.hpp"
#include "edged/dataset.hpp"

namespace edged {

/// Compares the cameras of the mode with the gyro until they have rotated enough. To be cheap, it uses few corners,
/// only during rotation, and only one of two cameras of the same lens. Most events are only counted.
class RunCheck {
 public:
  /// used: the cameras of the run; the first of each kind is checked. has_extrinsics: their poses are calibrated.
  RunCheck(const DatasetInfo& info, const Rig& used, bool has_extrinsics);

  /// To be called with each measurement before it is used. Those of other cameras are ignored.
  void add(const Measurement& measurement);

  /// Errors that have become certain since the last call.
  std::vector<Finding> news();

  /// Warnings and errors from all measurements. To be called after the last one. truth: that of the dataset.
  std::vector<Finding> findings(const Dataset& dataset, const std::optional<GroundTruth>& truth);

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
    bool twin = false;        ///< has the lens of the previous camera
    bool waits = false;       ///< the previous camera is checked instead, unless it has too little data
    /// Angle to a rotation that fits clearly better than the calibration, if the check of `edged doctor` is
    /// undetermined.
    double contradiction_deg = 0.0;
    std::optional<GyroAgreement> agreement = std::nullopt;
  };

  std::size_t surveyed_every(const Measurement& measurement);
  void follow(Camera& camera, const Measurement& measurement);
  void compare(Camera& camera);
  std::vector<Finding> judge(const Survey& survey) const;

  bool has_extrinsics_;
  Surveyor surveyor_;
  GyroIntegral gyro_;
  double rate_ = 0.0;  ///< running mean of the gyro rate [rad/s]
  AccelAxes accel_axes_;
  std::vector<Camera> cameras_;
  std::optional<Timestamp> first_imu_, first_visual_;  ///< first stamps
  Duration imu_{0}, visual_{0};                        ///< duration of each stream
  Timestamp counted_from_ = Timestamp::min();
  std::size_t counted_ = 0, every_ = 1;  ///< events since then; one of so many is surveyed in detail
  bool look_ = false, looked_ = false;   ///< state of the checks of the IMU
  std::vector<std::string> told_;
};

}  // namespace edged

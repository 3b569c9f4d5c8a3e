// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Checks during a run whether recording and calibration contradict each other: the cheap part of `edged doctor`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/dataset.hpp"
#include "edged/survey/accel_axes.hpp"
#include "edged/survey/diagnosis.hpp"

namespace edged {

/// The cameras of the mode are compared with the gyro until they have rotated enough. To be cheap, it uses few corners,
/// only during rotation, only one of two cameras behind one lens, and only counts most events.
class RunCheck {
 public:
  /// used: the cameras of the run; the first of each kind is checked. has_extrinsics: their poses are calibrated.
  RunCheck(const DatasetInfo& info, const Rig& used, bool has_extrinsics);

  /// Takes every measurement, before it is used; those of other cameras are ignored.
  void add(const Measurement& measurement);

  /// New errors that have become certain.
  std::vector<Finding> news();

  /// Warnings and errors from all measurements; after the last one. truth: that of the dataset.
  std::vector<Finding> findings(const Dataset& dataset, const std::optional<GroundTruth>& truth);

  /// Whether by the gyro, too, the camera is mounted as this one, which the run has estimated. After findings().
  bool agrees_with(const RigCamera& estimated) const;

 private:
  struct Camera {
    RigCamera given;
    VisualTurns visual;
    std::size_t counted = 0;  ///< of the turns
    Duration turning{0};      ///< duration of rotation so far
    Duration next_look{0};    ///< duration of rotation at the next comparison
    bool done = false;        ///< comparison finished
    bool twin = false;        ///< has the lens of the one before it
    bool waits = false;       ///< covered by that one, unless that has too little data
    /// Angle to the rotation that fits clearly better than the calibration, if the doctor's check is undetermined.
    double contradiction_deg = 0.0;
    std::optional<GyroAgreement> agreement = std::nullopt;
  };

  void follow(Camera& camera, const Measurement& measurement);
  void compare(Camera& camera);
  std::vector<Finding> judge(const Survey& survey) const;

  bool has_extrinsics_;
  Surveyor surveyor_;
  GyroIntegral gyro_;
  double rate_ = 0.0;  ///< of the gyro, at present [rad/s]
  AccelAxes accel_axes_;
  std::vector<Camera> cameras_;
  std::optional<Timestamp> first_imu_, first_visual_;  ///< first stamps
  Duration imu_{0}, visual_{0};                        ///< duration of each stream
  bool look_ = false, looked_ = false;                 ///< times of the next and of the last check
  std::vector<std::string> told_;
};

}  // namespace edged

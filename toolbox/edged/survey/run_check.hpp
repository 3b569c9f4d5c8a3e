// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether recording and calibration contradict each other, found while a run goes: what `edged doctor` checks, as far
// as it costs little.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/core/dataset.hpp"
#include "edged/survey/accel_axes.hpp"
#include "edged/survey/diagnosis.hpp"

namespace edged {

/// The cameras of the mode are held against the gyro until they have turned enough: with few corners, only while it
/// turns, and of two behind one lens only one. That, and that most events are only counted, makes it cheap.
class RunCheck {
 public:
  /// used: the cameras of the run; the first of each kind is checked. has_extrinsics: their poses are calibrated.
  RunCheck(const DatasetInfo& info, const Rig& used, bool has_extrinsics);

  /// Every measurement that comes, before it is used; those of other cameras are passed over.
  void add(const Measurement& measurement);

  /// Errors that have become certain and were not given out before.
  std::vector<Finding> news();

  /// Warnings and errors by all that has come; after the last measurement. truth: that of the dataset.
  std::vector<Finding> findings(const Dataset& dataset, const std::optional<GroundTruth>& truth);

 private:
  struct Camera {
    RigCamera given;
    VisualTurns visual;
    std::size_t counted = 0;  ///< of the turns
    Duration turning{0};      ///< time in which it turned, so far
    Duration next_look{0};    ///< compared again when it has turned for so long
    bool done = false;        ///< compared to satisfaction
    bool twin = false;        ///< has the lens of the one before it
    bool waits = false;       ///< for that one, unless it does not tell enough
    /// Of the rotation that explains its turning clearly better than the calibration's, where the doctor cannot judge.
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
  std::optional<Timestamp> first_imu_, first_visual_;  ///< stamps that came first
  Duration imu_{0}, visual_{0};                        ///< how long these have come
  bool look_ = false, looked_ = false;                 ///< there may be news; were looked for
  std::vector<std::string> told_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The clock of an IMU whose offset is known, and which drifts away from that of the cameras.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "edged/checks/agreement/visual_turns.hpp"
#include "edged/io/core/replaced_streams.hpp"
#include "edged/measurement.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Follows the drift: every minute the rotations of 20 s tell what is wrong with the corrected stamps, and a filter of
/// offset and drift turns the line by so little that the stamps never jump. Two crystals differ by up to 50 ppm.
class ImuDrift {
 public:
  /// camera: the one that has determined the offset, to sigma_s.
  ImuDrift(RigCamera camera, double sigma_s);

  /// To be called with each measurement, those of the IMU on `line`, which it changes where the drift is known better.
  void add(const Measurement& measurement, ClockLine& line);

 private:
  void end_minute(Timestamp now, ClockLine& line);
  void update(double t_s, double missing_s, double sigma_s);

  RigCamera camera_;
  std::optional<Timestamp> begin_;  ///< of the minute, by the camera
  std::vector<ImuSample> samples_;  ///< since the rotations are followed
  std::optional<VisualTurns> visual_;
  std::optional<double> updated_s_;  ///< when x_ is
  Eigen::Vector2d x_{0.0, 0.0};      ///< what is missing at corrected stamps [s], and its growth [s/s]
  Eigen::Matrix2d P_;                ///< covariance of x_
  double turned_ = 0.0;              ///< of the line so far
  bool told_ = false;                ///< in the log
};

}  // namespace edged

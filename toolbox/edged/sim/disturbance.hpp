// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The motion of a simulated recording with a disturbance.
#pragma once

#include "edged/sim/motion/trajectory.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

/// A motion with a disturbance, whose defaults are set. The clock of the path is stopped (for the position only in pure
/// rotation), or the body also rotates about one of its axes, or it is knocked. Transitions, such as slowing down or
/// turning to a wall, take place before and after the disturbance.
class DisturbedTrajectory {
 public:
  /// gyro_range [rad/s]; axis_B: unit axis of the rotations.
  DisturbedTrajectory(ContinuousTrajectory trajectory, const Disturbance& disturbance, double gyro_range,
                      const Eigen::Vector3d& axis_B)
      : trajectory_(std::move(trajectory)), disturbance_(disturbance), gyro_range_(gyro_range), axis_B_(axis_B) {}

  /// t: seconds since the start of the rest.
  Kinematics at(double t) const;

 private:
  /// Angle added to the path [rad] and its rate [rad/s].
  struct Turn {
    double angle = 0.0, rate = 0.0;
  };
  Kinematics on_stopped_clock(double t) const;
  Turn turn(double t) const;
  void knock(double t, Kinematics& k) const;

  ContinuousTrajectory trajectory_;
  Disturbance disturbance_;
  double gyro_range_;
  Eigen::Vector3d axis_B_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A disturbance of a recording: one at a known time, in the scene, in the motion or in the sensors.
#pragma once

#include "edged/sim/simulator_config.hpp"
#include "edged/sim/trajectory.hpp"

namespace edged {

/// A motion with a disturbance (with its defaults set): the clock of the path is stopped, for the position alone
/// in pure rotation; or the body turns about an axis of its own on top of it; or it is knocked. Transitions, such as
/// slowing down or turning to a wall, take place before the disturbance and after it.
class DisturbedTrajectory {
 public:
  /// gyro_range [rad/s]; axis_B: of the turns, unit.
  DisturbedTrajectory(ContinuousTrajectory trajectory, const Disturbance& disturbance, double gyro_range,
                      const Eigen::Vector3d& axis_B)
      : trajectory_(std::move(trajectory)), disturbance_(disturbance), gyro_range_(gyro_range), axis_B_(axis_B) {}

  /// t: seconds since the start of the rest.
  Kinematics at(double t) const;

 private:
  /// Angle on top of the path [rad] and its rate [rad/s].
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

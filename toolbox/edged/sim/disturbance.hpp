// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What goes wrong in a recording: one thing at a known time, in the scene, in the motion or in the sensors.
#pragma once

#include "edged/sim/simulator_config.hpp"
#include "edged/sim/trajectory.hpp"

namespace edged {

/// A motion with what a disturbance (filled in) makes of it: the clock of the path is stopped, for the position alone
/// in pure rotation; or the body turns about an axis of its own on top of it; or it is knocked. What takes up time, as
/// slowing down or turning round to a wall, is done before the disturbance and undone after it.
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

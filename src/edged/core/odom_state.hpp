// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The state of the body in the odometry frame O, as the estimator has it.
#pragma once

#include <Eigen/Core>

#include "edged/se3.hpp"
#include "edged/state.hpp"
#include "edged/time.hpp"

namespace edged {

/// The state of the body B in the odometry frame O (z up) at one instant; NavState is the same in the map frame.
struct OdomState {
  Timestamp t;  ///< IMU clock
  SE3 T_O_B;
  Eigen::Vector3d v_O = Eigen::Vector3d::Zero();         ///< velocity of B in O [m/s]
  Eigen::Vector3d bias_gyro = Eigen::Vector3d::Zero();   ///< [rad/s], measured = true + bias
  Eigen::Vector3d bias_accel = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

/// How well the odometry knows its newest state: one sigma of each.
struct OdomUncertainty {
  double tilt = 0.0;       ///< in the worst direction [rad]
  double velocity = 0.0;   ///< of each axis [m/s]
  double gyro_bias = 0.0;  ///< of each axis [rad/s]
};

}  // namespace edged

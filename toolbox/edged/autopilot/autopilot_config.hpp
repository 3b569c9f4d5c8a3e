// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Options of the output for autopilots.
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "edged/config.hpp"

namespace edged {

struct AutopilotConfig {
  std::string axes = "forward=x up=z";
  double rate_hz = 50.0;
  int system_id = 1;
  int component_id = 197;  // MAV_COMP_ID_VISUAL_INERTIAL_ODOMETRY
  void visit(ConfigFields& fields);

  /// R_V_B: from the body frame B, the axes of the IMU, to the axes V of the vehicle (forward, right, down). Throws
  /// InputError where `axes` is no such rotation.
  Eigen::Quaterniond R_V_B() const;
};

}  // namespace edged

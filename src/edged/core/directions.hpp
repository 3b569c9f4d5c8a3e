// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Directions in space.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "edged/se3.hpp"

namespace edged {

/// Between two vectors of any length [rad], 0 to pi; accurate near both.
inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The rotation about z that is nearest to R.
inline Eigen::Quaterniond nearest_yaw(const Eigen::Matrix3d& R) {
  return so3::exp({0.0, 0.0, std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1))});
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Directions in space.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace edged {

/// Between two vectors of any length [rad], 0 to pi; accurate near both.
inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace edged

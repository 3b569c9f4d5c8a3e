// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Directions in space.
#pragma once

#include <Eigen/Eigenvalues>
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

/// Standard deviation of the tilt in the worst direction [rad]; P_B: covariance of phi in R_true = R_O_B Exp(phi).
inline double tilt_sigma(const Eigen::Matrix3d& R_O_B, const Eigen::Matrix3d& P_B) {
  const Eigen::Matrix<double, 2, 3> horizontal = R_O_B.topRows<2>();
  const Eigen::Matrix2d P = horizontal * P_B * horizontal.transpose();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(P, Eigen::EigenvaluesOnly).eigenvalues()[1]);
}

}  // namespace edged

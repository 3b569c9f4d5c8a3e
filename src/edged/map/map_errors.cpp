// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/map_errors.hpp"

#include <algorithm>

namespace edged {
std::optional<LinearizedObservation> linearised(const MapObservation& observation, const SE3& T_M_B, const SE3& T_M_K,
                                                const SE3& T_B_C) {
  using Matrix23d = Eigen::Matrix<double, 2, 3>;
  const SE3 T_B_M = T_M_B.inverse(), T_C_B = T_B_C.inverse();
  const Eigen::Vector3d p_B = T_B_M * (T_M_K * observation.p_K), p_C = T_C_B * p_B;
  if (p_C.z() <= 0.0) return std::nullopt;
  Matrix23d of_p_B;
  of_p_B << 1.0 / p_C.z(), 0.0, -p_C.x() / (p_C.z() * p_C.z()), 0.0, 1.0 / p_C.z(), -p_C.y() / (p_C.z() * p_C.z());
  of_p_B *= T_C_B.R();
  const Matrix23d of_p_M = of_p_B * T_B_M.R();
  LinearizedObservation row;
  row.r = p_C.hnormalized() - observation.seen;
  row.by_body << -of_p_M, of_p_B * skew(p_B);
  row.by_keyframe << of_p_M, -of_p_M * T_M_K.R() * skew(observation.p_K);
  const Eigen::Vector2d along = of_p_M * T_M_K.R() * observation.depth_sigma_K;
  row.R = observation.sigma * observation.sigma * Eigen::Matrix2d::Identity() + along * along.transpose();
  return row;
}

Matrix6d transport(const SE3& T_M_A, const SE3& T_A_B) {
  Matrix6d F = Matrix6d::Identity();
  F.topRightCorner<3, 3>() = -T_M_A.R() * skew(T_A_B.translation());
  F.bottomRightCorner<3, 3>() = T_A_B.R().transpose();
  return F;
}

Eigen::Matrix3d rotation_covariance(const SE3& T_M_B, double yaw_variance, double tilt_variance) {
  const Eigen::Vector3d up_B = T_M_B.R().row(2);
  const Eigen::Matrix3d along_up = up_B * up_B.transpose();
  return yaw_variance * along_up + tilt_variance * (Eigen::Matrix3d::Identity() - along_up);
}

Drift drift_of(const OdomUncertainty& odometry) {
  const double turn = std::sqrt(kMapTuning.gyro_bias_time_s) * odometry.gyro_bias;
  return {std::sqrt(kMapTuning.velocity_time_s) * odometry.velocity, turn, turn};
}

Matrix6d drift_covariance(const Drift& drift, const SE3& T_M_B, double dt) {
  Matrix6d Q = Matrix6d::Zero();
  Q.diagonal().head<3>().setConstant(drift.position * drift.position * dt);
  Q.bottomRightCorner<3, 3>() = dt * rotation_covariance(T_M_B, drift.yaw * drift.yaw, drift.tilt * drift.tilt);
  return Q;
}

GravityObservation observed_gravity(const SE3& T_O_B, double dt, double sigma) {
  return {T_O_B.R().row(2), std::min(dt / kMapTuning.tilt_time_s, 1.0) / (sigma * sigma)};
}

/// r = up_M - up_B, both in B; J = skew(up_M).
LinearizedGravity linearised(const GravityObservation& observation, const SE3& T_M_B) {
  const Eigen::Vector3d up_M = T_M_B.R().row(2);
  return {observation.information * (Eigen::Matrix3d::Identity() - up_M * up_M.transpose()),
          observation.information * up_M.cross(observation.up_B)};
}

SE3 corrected(const SE3& T, const Vector6d& error) {
  return {T.rotation() * so3::exp(error.tail<3>()), T.translation() + error.head<3>()};
}

}  // namespace edged

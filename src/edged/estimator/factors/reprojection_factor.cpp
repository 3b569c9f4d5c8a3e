// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/reprojection_factor.hpp"

#include "edged/estimator/factors/blocks.hpp"

namespace edged {

bool ReprojectionFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  using Eigen::Matrix3d;
  using Eigen::Vector3d;
  const SE3 T_W_B0 = pose_of(blocks[0]), T_W_B1 = pose_of(blocks[1]);
  const double rho = blocks[2][0];

  // Everything is scaled by rho, so that points at infinity (rho = 0) are ordinary points.
  const Matrix3d R_C_B = T_B_C_.R().transpose();
  const Matrix3d R_W_B0 = T_W_B0.R(), R_B1_W = T_W_B1.R().transpose();
  const Vector3d x_B0 = T_B_C_.rotation() * anchor_ + rho * T_B_C_.translation();
  const Vector3d x_W = R_W_B0 * x_B0 + rho * (T_W_B0.translation() - T_W_B1.translation());
  const Vector3d x_B1 = R_B1_W * x_W;
  const Vector3d x_C1 = R_C_B * (x_B1 - rho * T_B_C_.translation());
  if (x_C1.z() < kMinDepthShare) return false;

  const double z_inv = 1.0 / x_C1.z();
  const Eigen::Vector2d predicted = x_C1.head<2>() * z_inv;
  Eigen::Map<Eigen::Vector2d> r(residuals);
  r = weight_ * (predicted - seen_);
  if (jacobians == nullptr) return true;

  Eigen::Matrix<double, 2, 3> d_r_d_x;
  d_r_d_x << z_inv, 0, -predicted.x() * z_inv, 0, z_inv, -predicted.y() * z_inv;
  d_r_d_x *= weight_;
  const Eigen::Matrix<double, 2, 3> d_r_d_xB1 = d_r_d_x * R_C_B;
  const Eigen::Matrix<double, 2, 3> d_r_d_xW = d_r_d_xB1 * R_B1_W;
  using Jacobian = Eigen::Matrix<double, 2, 7, Eigen::RowMajor>;
  if (jacobians[0] != nullptr) {
    Eigen::Map<Jacobian> J(jacobians[0]);
    J.leftCols<3>() = rho * d_r_d_xW;
    J.middleCols<3>(3).noalias() = -d_r_d_xW * R_W_B0 * skew(x_B0);
    J.col(6).setZero();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Jacobian> J(jacobians[1]);
    J.leftCols<3>() = -rho * d_r_d_xW;
    J.middleCols<3>(3).noalias() = d_r_d_xB1 * skew(x_B1);
    J.col(6).setZero();
  }
  if (jacobians[2] != nullptr) {
    Eigen::Map<Eigen::Vector2d> J(jacobians[2]);
    J = d_r_d_xW * (R_W_B0 * T_B_C_.translation() + T_W_B0.translation() - T_W_B1.translation()) -
        d_r_d_x * (R_C_B * T_B_C_.translation());
  }
  return true;
}

}  // namespace edged

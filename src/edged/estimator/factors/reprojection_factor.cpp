// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/reprojection_factor.hpp"

#include "edged/estimator/factors/blocks.hpp"

namespace edged {
namespace {

/// A body moved on along its rate.
SE3 moved_body(const SE3& T_W_B, const BodyRate& rate, double time) {
  return {T_W_B.rotation() * so3::exp(rate.omega_B * time), T_W_B.translation() + rate.v_W * time};
}

}  // namespace

SE3 camera_pose(const SE3& T_W_B, const BodyRate& rate, const SE3& T_B_C, const double* calibration) {
  const Eigen::Map<const Eigen::Vector3d> phi(calibration);
  return moved_body(T_W_B, rate, calibration[3]) * SE3(T_B_C.rotation() * so3::exp(phi), T_B_C.translation());
}

bool ReprojectionFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  using Eigen::Matrix3d;
  using Eigen::Vector3d;
  const Vector3d phi = Eigen::Map<const Vector3d>(blocks[2]);
  const double time = blocks[2][3], rho = blocks[3][0];
  const SE3 T_W_B0 = moved_body(pose_of(blocks[0]), anchor_.rate, time),
            T_W_B1 = moved_body(pose_of(blocks[1]), seen_.rate, time);

  // Everything is scaled by rho, so that points at infinity (rho = 0) are ordinary points.
  const Vector3d bearing = anchor_.point.homogeneous(), t_B_C = T_B_C_.translation();
  const Matrix3d R_B_C = (T_B_C_.rotation() * so3::exp(phi)).toRotationMatrix(), R_C_B = R_B_C.transpose();
  const Matrix3d R_W_B0 = T_W_B0.R(), R_B1_W = T_W_B1.R().transpose();
  const Vector3d x_B0 = R_B_C * bearing + rho * t_B_C;
  const Vector3d x_W = R_W_B0 * x_B0 + rho * (T_W_B0.translation() - T_W_B1.translation());
  const Vector3d x_B1 = R_B1_W * x_W;
  const Vector3d x_C1 = R_C_B * (x_B1 - rho * t_B_C);
  if (x_C1.z() < kMinDepthShare) return false;

  const double z_inv = 1.0 / x_C1.z();
  const Eigen::Vector2d predicted = x_C1.head<2>() * z_inv;
  Eigen::Map<Eigen::Vector2d> r(residuals);
  r = weight_ * (predicted - seen_.point);
  if (jacobians == nullptr) return true;

  Eigen::Matrix<double, 2, 3> d_r_d_x;
  d_r_d_x << z_inv, 0, -predicted.x() * z_inv, 0, z_inv, -predicted.y() * z_inv;
  d_r_d_x *= weight_;
  const Eigen::Matrix<double, 2, 3> d_r_d_xB1 = d_r_d_x * R_C_B;
  const Eigen::Matrix<double, 2, 3> d_r_d_xW = d_r_d_xB1 * R_B1_W;
  // A turn of the state's body is one of the moved body seen along Exp(omega time).
  using Jacobian = Eigen::Matrix<double, 2, 7, Eigen::RowMajor>;
  if (jacobians[0] != nullptr) {
    Eigen::Map<Jacobian> J(jacobians[0]);
    const Matrix3d back = so3::exp(anchor_.rate.omega_B * -time).toRotationMatrix();
    J.leftCols<3>() = rho * d_r_d_xW;
    J.middleCols<3>(3).noalias() = -d_r_d_xW * R_W_B0 * skew(x_B0) * back;
    J.col(6).setZero();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Jacobian> J(jacobians[1]);
    const Matrix3d back = so3::exp(seen_.rate.omega_B * -time).toRotationMatrix();
    J.leftCols<3>() = -rho * d_r_d_xW;
    J.middleCols<3>(3).noalias() = d_r_d_xB1 * skew(x_B1) * back;
    J.col(6).setZero();
  }
  if (jacobians[2] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, 4, Eigen::RowMajor>> J(jacobians[2]);
    const Matrix3d Jr = so3::right_jacobian(phi);
    J.leftCols<3>() = (d_r_d_x * skew(x_C1) - d_r_d_xW * R_W_B0 * R_B_C * skew(bearing)) * Jr;
    J.col(3) = d_r_d_xW * (R_W_B0 * anchor_.rate.omega_B.cross(x_B0) + rho * (anchor_.rate.v_W - seen_.rate.v_W)) -
               d_r_d_xB1 * seen_.rate.omega_B.cross(x_B1);
  }
  if (jacobians[3] != nullptr) {
    Eigen::Map<Eigen::Vector2d> J(jacobians[3]);
    J = d_r_d_xW * (R_W_B0 * t_B_C + T_W_B0.translation() - T_W_B1.translation()) - d_r_d_x * (R_C_B * t_B_C);
  }
  return true;
}

}  // namespace edged

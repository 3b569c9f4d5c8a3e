// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/imu_factor.hpp"

#include <Eigen/Cholesky>

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using PoseJacobian = Eigen::Matrix<double, 15, 7, Eigen::RowMajor>;
using MotionJacobian = Eigen::Matrix<double, 15, 9, Eigen::RowMajor>;

using IntrinsicsJacobian = Eigen::Matrix<double, 15, 18, Eigen::RowMajor>;
using RowMajor3 = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

// Rows of the residual.
constexpr int kPhi = 0, kV = 3, kP = 6, kBg = 9, kBa = 12;
// Columns of a pose tangent and of a motion block.
constexpr int kPosePos = 0, kPosePhi = 3, kMotionV = 0, kMotionBg = 3, kMotionBa = 6;

struct Motion {
  explicit Motion(const double* b) : v(b), bg(b + 3), ba(b + 6) {}
  Eigen::Map<const Vector3d> v, bg, ba;
};

/// Derivatives of the residual, before it is whitened, with respect to the biases over the interval.
struct BiasDerivatives {
  BiasDerivatives(const Preintegration& imu, const Vector3d& bias_gyro, const Matrix3d& J_r_inv,
                  const Vector3d& dR_error) {
    const Vector3d correction = imu.d_dR_d_bg() * (bias_gyro - imu.bias_gyro());
    gyro.middleRows<3>(kPhi) =
        -J_r_inv * so3::exp(-dR_error).toRotationMatrix() * so3::right_jacobian(correction) * imu.d_dR_d_bg();
    gyro.middleRows<3>(kV) = -imu.d_dv_d_bg();
    gyro.middleRows<3>(kP) = -imu.d_dp_d_bg();
    accel.middleRows<3>(kV) = -imu.d_dv_d_ba();
    accel.middleRows<3>(kP) = -imu.d_dp_d_ba();
  }

  /// Row i of E times the mean reading adds to bias i.
  IntrinsicsJacobian by_intrinsics(const Preintegration& imu) const {
    IntrinsicsJacobian J;
    for (int row = 0; row < 3; ++row) {
      J.middleCols<3>(3 * row) = gyro.col(row) * imu.mean_gyro().transpose();
      J.middleCols<3>(9 + 3 * row) = accel.col(row) * imu.mean_accel().transpose();
    }
    return J;
  }

  Eigen::Matrix<double, 15, 3> gyro = Eigen::Matrix<double, 15, 3>::Zero(), accel = gyro;
};

}  // namespace

ImuFactor::ImuFactor(StateId a, StateId b, const Preintegration& imu)
    : Factor(15, {{BlockKind::Pose, a},
                  {BlockKind::Motion, a},
                  {BlockKind::Pose, b},
                  {BlockKind::Motion, b},
                  kImuIntrinsicsKey}),
      imu_(imu) {
  // A floor far below any real noise keeps the factorisation stable for very short intervals.
  constexpr double kFloor = 1e-14;
  const Matrix9d covariance = imu.covariance() + kFloor * Matrix9d::Identity();
  const Eigen::LLT<Matrix9d> llt(covariance);
  whiten_motion_ = llt.matrixL().solve(Matrix9d::Identity());
  const double root_dt = std::sqrt(std::max(imu.dt(), 1e-6));
  whiten_biases_.head<3>().setConstant(1.0 / (imu.noise().gyro_walk * root_dt));
  whiten_biases_.tail<3>().setConstant(1.0 / (imu.noise().accel_walk * root_dt));
}

std::shared_ptr<Factor> ImuFactor::without(const DroppedState& dropped) const {
  const bool into = blocks()[2].id == dropped.id;  // factor of the dropped state; it covers both
  if (into) return nullptr;
  auto joined = std::make_shared<ImuFactor>(dropped.before, dropped.after, dropped.imu);
  joined->weight_ = weight_;
  return joined;
}

bool ImuFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const SE3 T_0 = pose_of(blocks[0]), T_1 = pose_of(blocks[2]);
  const Motion m_0(blocks[1]), m_1(blocks[3]);
  const Vector3d bg = m_0.bg + RowMajor3(blocks[4]) * imu_.mean_gyro(),
                 ba = m_0.ba + RowMajor3(blocks[4] + 9) * imu_.mean_accel();
  const double dt = imu_.dt();
  const Matrix3d R_0_inv = T_0.R().transpose();
  const Vector3d dR_error = so3::log(imu_.dR(bg).conjugate() * (T_0.rotation().conjugate() * T_1.rotation()));
  const Vector3d v_change_B0 = R_0_inv * (m_1.v - m_0.v - kGravity_W * dt);
  const Vector3d p_change_B0 =
      R_0_inv * (T_1.translation() - T_0.translation() - m_0.v * dt - 0.5 * kGravity_W * dt * dt);

  Eigen::Matrix<double, 15, 1> r;
  r.segment<3>(kPhi) = dR_error;
  r.segment<3>(kV) = v_change_B0 - imu_.dv(bg, ba);
  r.segment<3>(kP) = p_change_B0 - imu_.dp(bg, ba);
  r.segment<3>(kBg) = m_1.bg - m_0.bg;
  r.segment<3>(kBa) = m_1.ba - m_0.ba;
  Eigen::Map<Eigen::Matrix<double, 15, 1>>{residuals} = whitened(r);
  if (jacobians == nullptr) return true;

  const Matrix3d J_r_inv = so3::right_jacobian_inverse(dR_error);
  if (jacobians[0] != nullptr) {
    PoseJacobian J = PoseJacobian::Zero();
    J.block<3, 3>(kPhi, kPosePhi) = -J_r_inv * (T_1.R().transpose() * T_0.R());
    J.block<3, 3>(kV, kPosePhi) = skew(v_change_B0);
    J.block<3, 3>(kP, kPosePhi) = skew(p_change_B0);
    J.block<3, 3>(kP, kPosePos) = -R_0_inv;
    Eigen::Map<PoseJacobian>{jacobians[0]} = whitened(J);
  }
  const BiasDerivatives by_bias(imu_, bg, J_r_inv, dR_error);
  if (jacobians[1] != nullptr) {
    MotionJacobian J = MotionJacobian::Zero();
    J.block<3, 3>(kV, kMotionV) = -R_0_inv;
    J.block<3, 3>(kP, kMotionV) = -R_0_inv * dt;
    J.middleCols<3>(kMotionBg) = by_bias.gyro;
    J.middleCols<3>(kMotionBa) = by_bias.accel;
    J.block<3, 3>(kBg, kMotionBg) = -Matrix3d::Identity();
    J.block<3, 3>(kBa, kMotionBa) = -Matrix3d::Identity();
    Eigen::Map<MotionJacobian>{jacobians[1]} = whitened(J);
  }
  if (jacobians[2] != nullptr) {
    PoseJacobian J = PoseJacobian::Zero();
    J.block<3, 3>(kPhi, kPosePhi) = J_r_inv;
    J.block<3, 3>(kP, kPosePos) = R_0_inv;
    Eigen::Map<PoseJacobian>{jacobians[2]} = whitened(J);
  }
  if (jacobians[3] != nullptr) {
    MotionJacobian J = MotionJacobian::Zero();
    J.block<3, 3>(kV, kMotionV) = R_0_inv;
    J.block<3, 3>(kBg, kMotionBg) = Matrix3d::Identity();
    J.block<3, 3>(kBa, kMotionBa) = Matrix3d::Identity();
    Eigen::Map<MotionJacobian>{jacobians[3]} = whitened(J);
  }
  if (jacobians[4] != nullptr) {
    Eigen::Map<IntrinsicsJacobian>{jacobians[4]} = whitened(by_bias.by_intrinsics(imu_));
  }
  return true;
}

}  // namespace edged

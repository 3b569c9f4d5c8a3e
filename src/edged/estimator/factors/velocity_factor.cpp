// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/velocity_factor.hpp"

#include "edged/imu/preintegration.hpp"

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kVelocityLoss = 2.0;  // [sigma]

}  // namespace

VelocityFactor::Way VelocityFactor::Way::after(const Preintegration& imu) const {
  const Vector3d &bias_gyro = imu.bias_gyro(), &bias_accel = imu.bias_accel();
  Way way;
  way.by_velocity = by_velocity * imu.dR(bias_gyro).toRotationMatrix().transpose();
  way.by_gravity = by_gravity * imu.dR(bias_gyro).toRotationMatrix().transpose() + imu.dt() * way.by_velocity;
  way.by_gyro = by_gyro + way.by_velocity * imu.d_dv_d_bg();
  way.by_accel = by_accel + way.by_velocity * imu.d_dv_d_ba();
  way.off = off + way.by_velocity *
                      (imu.dv(bias_gyro, bias_accel) - imu.d_dv_d_bg() * bias_gyro - imu.d_dv_d_ba() * bias_accel);
  return way;
}

void VelocityFactor::Way::add(const Vector3d& share, const Way& other) {
  by_velocity += share.asDiagonal() * (other.by_velocity - by_velocity);
  by_gravity += share.asDiagonal() * (other.by_gravity - by_gravity);
  by_gyro += share.asDiagonal() * (other.by_gyro - by_gyro);
  by_accel += share.asDiagonal() * (other.by_accel - by_accel);
  off += share.asDiagonal() * (other.off - off);
}

VelocityFactor::VelocityFactor(StateId state, BlockKey scale, Way way, const Vector3d& measured, const Vector3d& weight)
    : Factor(3, {{BlockKind::Pose, state}, {BlockKind::Motion, state}, scale}),
      way_(std::move(way)),
      measured_(measured),
      weight_(weight),
      loss_(kVelocityLoss) {}

VelocityFactor::VelocityFactor(StateId state, BlockKey scale, const Preintegration& imu, const SE3& T_B_S,
                               const VelocitySample& sample)
    : VelocityFactor(state, scale, Way{}, sample.v_S, sample.sigma.cwiseInverse().cwiseAbs2()) {
  const Matrix3d R_S_B = T_B_S.R().transpose();
  const Vector3d& omega_B = imu.samples().back().gyro_B;
  const Way there{R_S_B, Matrix3d::Zero(), R_S_B * skew(T_B_S.translation()), Matrix3d::Zero(),
                  R_S_B * omega_B.cross(T_B_S.translation())};
  way_ = there.after(imu);
  measured_ = (weight_.array() > 0.0).select(measured_.array(), 0.0);  // it may be no number
}

bool VelocityFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const Matrix3d R_B_O = pose_of(blocks[0]).R().transpose();
  const Eigen::Map<const Vector3d> v_O(blocks[1]), bias_gyro(blocks[1] + 3), bias_accel(blocks[1] + 6);
  const Vector3d v_B = R_B_O * v_O, g_B = R_B_O * kGravity_W, per_sigma = weight_.cwiseSqrt();
  const Vector3d predicted =
      way_.by_velocity * v_B + way_.by_gravity * g_B + way_.off + way_.by_gyro * bias_gyro + way_.by_accel * bias_accel;
  Eigen::Map<Vector3d>{residuals} = per_sigma.asDiagonal() * ((1.0 + blocks[2][0]) * predicted - measured_);
  if (jacobians == nullptr) return true;
  const Vector3d scale = (1.0 + blocks[2][0]) * per_sigma;
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> J(jacobians[0]);
    J.setZero();
    J.middleCols<3>(3) = scale.asDiagonal() * (way_.by_velocity * skew(v_B) + way_.by_gravity * skew(g_B));
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 9, Eigen::RowMajor>> J(jacobians[1]);
    J << way_.by_velocity * R_B_O, way_.by_gyro, way_.by_accel;
    J = (scale.asDiagonal() * J).eval();
  }
  if (jacobians[2] != nullptr) Eigen::Map<Vector3d>{jacobians[2]} = per_sigma.asDiagonal() * predicted;
  return true;
}

bool VelocityFactor::marginalized_with(const std::set<BlockKey>& leaving) const {
  return leaving.contains(blocks()[0]);
}

std::shared_ptr<Factor> VelocityFactor::without(const DroppedState& dropped) const {
  return std::shared_ptr<Factor>(
      new VelocityFactor(dropped.before, blocks()[2], way_.after(dropped.imu_into), measured_, weight_));
}

bool VelocityFactor::absorb(const Factor& other) {
  const auto* velocities = dynamic_cast<const VelocityFactor*>(&other);
  if (velocities == nullptr) return false;
  weight_ += velocities->weight_;
  // 0 of 0 where an axis has not been measured.
  const Vector3d share =
      (weight_.array() > 0.0).select(velocities->weight_.cwiseQuotient(weight_).array(), 0.0).matrix();
  way_.add(share, velocities->way_);
  measured_ += share.asDiagonal() * (velocities->measured_ - measured_);
  return true;
}

}  // namespace edged

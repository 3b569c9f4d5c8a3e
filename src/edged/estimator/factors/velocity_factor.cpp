// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/velocity_factor.hpp"

#include "edged/estimator/tuning.hpp"
#include "edged/imu/preintegration.hpp"

namespace edged {

using Eigen::Matrix3d;
using Eigen::Vector3d;

VelocityFactor::PropagatedVelocity VelocityFactor::PropagatedVelocity::from_state_before(
    const Preintegration& imu) const {
  const Vector3d &bias_gyro = imu.bias_gyro(), &bias_accel = imu.bias_accel();
  PropagatedVelocity next;
  next.d_v = d_v * imu.dR(bias_gyro).toRotationMatrix().transpose();
  next.d_g = d_g * imu.dR(bias_gyro).toRotationMatrix().transpose() + imu.dt() * next.d_v;
  next.d_bg = d_bg + next.d_v * imu.d_dv_d_bg();
  next.d_ba = d_ba + next.d_v * imu.d_dv_d_ba();
  next.constant = constant + next.d_v * (imu.dv(bias_gyro, bias_accel) - imu.d_dv_d_bg() * bias_gyro -
                                         imu.d_dv_d_ba() * bias_accel);
  return next;
}

void VelocityFactor::PropagatedVelocity::average_with(const Vector3d& share, const PropagatedVelocity& other) {
  d_v += share.asDiagonal() * (other.d_v - d_v);
  d_g += share.asDiagonal() * (other.d_g - d_g);
  d_bg += share.asDiagonal() * (other.d_bg - d_bg);
  d_ba += share.asDiagonal() * (other.d_ba - d_ba);
  constant += share.asDiagonal() * (other.constant - constant);
}

VelocityFactor::VelocityFactor(StateId state, BlockKey scale, PropagatedVelocity propagated, const Vector3d& measured,
                               const Vector3d& weight)
    : Factor(3, {{BlockKind::Pose, state}, {BlockKind::Motion, state}, scale}),
      propagated_(std::move(propagated)),
      measured_(measured),
      weight_(weight),
      loss_(kFactorTuning.external_cauchy_scale) {}

VelocityFactor::VelocityFactor(StateId state, BlockKey scale, const Preintegration& imu, const SE3& T_B_S,
                               const VelocitySample& sample)
    : VelocityFactor(state, scale, PropagatedVelocity{}, sample.v_S, sample.sigma.cwiseInverse().cwiseAbs2()) {
  const Matrix3d R_S_B = T_B_S.R().transpose();
  const Vector3d& omega_B = imu.samples().back().gyro_B;
  const PropagatedVelocity there{R_S_B, Matrix3d::Zero(), R_S_B * skew(T_B_S.translation()), Matrix3d::Zero(),
                                 R_S_B * omega_B.cross(T_B_S.translation())};
  propagated_ = there.from_state_before(imu);
  measured_ = (weight_.array() > 0.0).select(measured_.array(), 0.0);  // it may be no number
}

bool VelocityFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const Matrix3d R_B_O = pose_of(blocks[0]).R().transpose();
  const Eigen::Map<const Vector3d> v_O(blocks[1]), bias_gyro(blocks[1] + 3), bias_accel(blocks[1] + 6);
  const Vector3d v_B = R_B_O * v_O, g_B = R_B_O * kGravity_W, per_sigma = weight_.cwiseSqrt();
  const Vector3d predicted = propagated_.d_v * v_B + propagated_.d_g * g_B + propagated_.constant +
                             propagated_.d_bg * bias_gyro + propagated_.d_ba * bias_accel;
  Eigen::Map<Vector3d>{residuals} = per_sigma.asDiagonal() * ((1.0 + blocks[2][0]) * predicted - measured_);
  if (jacobians == nullptr) return true;
  const Vector3d scale = (1.0 + blocks[2][0]) * per_sigma;
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> J(jacobians[0]);
    J.setZero();
    J.middleCols<3>(3) = scale.asDiagonal() * (propagated_.d_v * skew(v_B) + propagated_.d_g * skew(g_B));
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 9, Eigen::RowMajor>> J(jacobians[1]);
    J << propagated_.d_v * R_B_O, propagated_.d_bg, propagated_.d_ba;
    J = (scale.asDiagonal() * J).eval();
  }
  if (jacobians[2] != nullptr) Eigen::Map<Vector3d>{jacobians[2]} = per_sigma.asDiagonal() * predicted;
  return true;
}

bool VelocityFactor::marginalized_with(const std::set<BlockKey>& leaving) const {
  return leaving.contains(blocks()[0]);
}

std::shared_ptr<Factor> VelocityFactor::without(const DroppedState& dropped) const {
  return std::shared_ptr<Factor>(new VelocityFactor(
      dropped.before, blocks()[2], propagated_.from_state_before(dropped.imu_into), measured_, weight_));
}

bool VelocityFactor::merge(const Factor& other) {
  const auto* velocities = dynamic_cast<const VelocityFactor*>(&other);
  if (velocities == nullptr) return false;
  weight_ += velocities->weight_;
  // 0 of 0 where an axis has not been measured.
  const Vector3d share =
      (weight_.array() > 0.0).select(velocities->weight_.cwiseQuotient(weight_).array(), 0.0).matrix();
  propagated_.average_with(share, velocities->propagated_);
  measured_ += share.asDiagonal() * (velocities->measured_ - measured_);
  return true;
}

}  // namespace edged

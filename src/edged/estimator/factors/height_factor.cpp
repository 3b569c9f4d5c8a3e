// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/height_factor.hpp"

#include <cmath>

#include "edged/estimator/tuning.hpp"
#include "edged/imu/preintegration.hpp"

namespace edged {

HeightFactor::PropagatedPosition HeightFactor::PropagatedPosition::from_state_before(const Preintegration& imu) const {
  const Eigen::Vector3d &bias_gyro = imu.bias_gyro(), &bias_accel = imu.bias_accel();
  const Eigen::Matrix3d R = imu.dR(bias_gyro).toRotationMatrix();
  const Eigen::Vector3d w = R * (d_p + d_p_d_bg * bias_gyro + d_p_d_ba * bias_accel);
  PropagatedPosition next;
  next.dt = imu.dt() + dt;
  next.half_dt2 = 0.5 * imu.dt() * imu.dt() + imu.dt() * dt + half_dt2;
  next.d_p_d_bg = imu.d_dp_d_bg() + dt * imu.d_dv_d_bg() + R * d_p_d_bg -
                  skew(w) * R * imu.d_dR_d_bg();  // R Exp(J d) m = R m - R [m] J d, and R [m] = [R m] R
  next.d_p_d_ba = imu.d_dp_d_ba() + dt * imu.d_dv_d_ba() + R * d_p_d_ba;
  next.d_p = imu.dp(bias_gyro, bias_accel) + dt * imu.dv(bias_gyro, bias_accel) + w - next.d_p_d_bg * bias_gyro -
             next.d_p_d_ba * bias_accel;
  return next;
}

void HeightFactor::PropagatedPosition::average_with(double share, const PropagatedPosition& other) {
  dt += share * (other.dt - dt);
  half_dt2 += share * (other.half_dt2 - half_dt2);
  d_p += share * (other.d_p - d_p);
  d_p_d_bg += share * (other.d_p_d_bg - d_p_d_bg);
  d_p_d_ba += share * (other.d_p_d_ba - d_p_d_ba);
}

Eigen::Vector3d HeightFactor::PropagatedPosition::in_body(const double* motion) const {
  const Eigen::Map<const Eigen::Vector3d> bias_gyro(motion + 3), bias_accel(motion + 6);
  return d_p + d_p_d_bg * bias_gyro + d_p_d_ba * bias_accel;
}

HeightFactor::HeightFactor(StateId state, BlockKey bias, const Preintegration& imu, double height_m, double sigma)
    : HeightFactor(state, bias, PropagatedPosition().from_state_before(imu), height_m, 1.0 / (sigma * sigma)) {}

HeightFactor::HeightFactor(StateId state, BlockKey bias, PropagatedPosition propagated, double height_m, double weight)
    : Factor(1, {{BlockKind::Pose, state}, {BlockKind::Motion, state}, bias}),
      propagated_(std::move(propagated)),
      height_m_(height_m),
      weight_(weight),
      loss_(kFactorTuning.external_cauchy_scale) {}

double HeightFactor::bias_at(const double* pose, const double* motion) const {
  const double z = pose[2] + propagated_.dt * motion[2] + kGravity_W.z() * propagated_.half_dt2 +
                   pose_of(pose).R().row(2).dot(propagated_.in_body(motion));
  return height_m_ - z;
}

bool HeightFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const double scale = std::sqrt(weight_);
  residuals[0] = scale * (blocks[2][0] - bias_at(blocks[0], blocks[1]));
  if (jacobians == nullptr) return true;
  const Eigen::RowVector3d up_B = scale * pose_of(blocks[0]).R().row(2);
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 1, 7>> J(jacobians[0]);
    J << 0.0, 0.0, scale, -up_B * skew(propagated_.in_body(blocks[1])), 0.0;
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 1, 9>> J(jacobians[1]);
    J << 0.0, 0.0, scale * propagated_.dt, up_B * propagated_.d_p_d_bg, up_B * propagated_.d_p_d_ba;
  }
  if (jacobians[2] != nullptr) jacobians[2][0] = scale;
  return true;
}

bool HeightFactor::marginalized_with(const std::set<BlockKey>& leaving) const { return leaving.contains(blocks()[0]); }

std::shared_ptr<Factor> HeightFactor::without(const DroppedState& dropped) const {
  return std::shared_ptr<Factor>(new HeightFactor(dropped.before, blocks()[2],
                                                  propagated_.from_state_before(dropped.imu_into), height_m_, weight_));
}

bool HeightFactor::merge(const Factor& other) {
  const auto* heights = dynamic_cast<const HeightFactor*>(&other);
  if (heights == nullptr) return false;
  weight_ += heights->weight_;
  const double share = heights->weight_ / weight_;
  propagated_.average_with(share, heights->propagated_);
  height_m_ += share * (heights->height_m_ - height_m_);
  return true;
}

}  // namespace edged

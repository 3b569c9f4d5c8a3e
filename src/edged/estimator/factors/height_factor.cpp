// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/height_factor.hpp"

#include <cmath>

#include "edged/imu/preintegration.hpp"

namespace edged {
namespace {

constexpr double kHeightLoss = 2.0;  // [sigma]

}  // namespace

HeightFactor::Way HeightFactor::Way::after(const Preintegration& imu) const {
  const Eigen::Vector3d &bias_gyro = imu.bias_gyro(), &bias_accel = imu.bias_accel();
  const Eigen::Matrix3d R = imu.dR(bias_gyro).toRotationMatrix();
  const Eigen::Vector3d w = R * (moved + by_gyro * bias_gyro + by_accel * bias_accel);
  Way way;
  way.dt = imu.dt() + dt;
  way.half_dt2 = 0.5 * imu.dt() * imu.dt() + imu.dt() * dt + half_dt2;
  way.by_gyro = imu.d_dp_d_bg() + dt * imu.d_dv_d_bg() + R * by_gyro -
                skew(w) * R * imu.d_dR_d_bg();  // R Exp(J d) m = R m - R [m] J d, and R [m] = [R m] R
  way.by_accel = imu.d_dp_d_ba() + dt * imu.d_dv_d_ba() + R * by_accel;
  way.moved = imu.dp(bias_gyro, bias_accel) + dt * imu.dv(bias_gyro, bias_accel) + w - way.by_gyro * bias_gyro -
              way.by_accel * bias_accel;
  return way;
}

void HeightFactor::Way::add(double share, const Way& other) {
  dt += share * (other.dt - dt);
  half_dt2 += share * (other.half_dt2 - half_dt2);
  moved += share * (other.moved - moved);
  by_gyro += share * (other.by_gyro - by_gyro);
  by_accel += share * (other.by_accel - by_accel);
}

Eigen::Vector3d HeightFactor::Way::in_body(const double* motion) const {
  const Eigen::Map<const Eigen::Vector3d> bias_gyro(motion + 3), bias_accel(motion + 6);
  return moved + by_gyro * bias_gyro + by_accel * bias_accel;
}

HeightFactor::HeightFactor(StateId state, BlockKey bias, const Preintegration& imu, double height_m, double sigma)
    : HeightFactor(state, bias, Way().after(imu), height_m, 1.0 / (sigma * sigma)) {}

HeightFactor::HeightFactor(StateId state, BlockKey bias, Way way, double height_m, double weight)
    : Factor(1, {{BlockKind::Pose, state}, {BlockKind::Motion, state}, bias}),
      way_(std::move(way)),
      height_m_(height_m),
      weight_(weight),
      loss_(kHeightLoss) {}

double HeightFactor::bias_at(const double* pose, const double* motion) const {
  const double z = pose[2] + way_.dt * motion[2] + kGravity_W.z() * way_.half_dt2 +
                   pose_of(pose).R().row(2).dot(way_.in_body(motion));
  return height_m_ - z;
}

bool HeightFactor::Evaluate(double const* const* blocks, double* residuals, double** jacobians) const {
  const double scale = std::sqrt(weight_);
  residuals[0] = scale * (blocks[2][0] - bias_at(blocks[0], blocks[1]));
  if (jacobians == nullptr) return true;
  const Eigen::RowVector3d up_B = scale * pose_of(blocks[0]).R().row(2);
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 1, 7>> J(jacobians[0]);
    J << 0.0, 0.0, scale, -up_B * skew(way_.in_body(blocks[1])), 0.0;
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 1, 9>> J(jacobians[1]);
    J << 0.0, 0.0, scale * way_.dt, up_B * way_.by_gyro, up_B * way_.by_accel;
  }
  if (jacobians[2] != nullptr) jacobians[2][0] = scale;
  return true;
}

bool HeightFactor::marginalized_with(const std::set<BlockKey>& leaving) const { return leaving.contains(blocks()[0]); }

std::shared_ptr<Factor> HeightFactor::without(const DroppedState& dropped) const {
  return std::shared_ptr<Factor>(
      new HeightFactor(dropped.before, blocks()[2], way_.after(dropped.imu_into), height_m_, weight_));
}

bool HeightFactor::absorb(const Factor& other) {
  const auto* heights = dynamic_cast<const HeightFactor*>(&other);
  if (heights == nullptr) return false;
  weight_ += heights->weight_;
  const double share = heights->weight_ / weight_;
  way_.add(share, heights->way_);
  height_m_ += share * (heights->height_m_ - height_m_);
  return true;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The velocity factor: velocities of a sensor on the body, in its own axes, measured in the IMU interval after a state.
#pragma once

#include "edged/estimator/factors/factor.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// Blocks: pose and motion of the state before the samples, scale error of the sensor. Residual (3): (1 + scale error)
/// R_S_B (R_B_O v + omega x t_B_S) there - measurement, over its sigmas; 0 for an axis without a measurement. The IMU
/// propagates the state to the time of a sample (docs/math.md, X3), with the gyro bias of that time for the rotation.
/// Many samples merge into their weighted mean, and those of a dropped state move to the state before, as those of
/// height do.
class VelocityFactor final : public Factor {
 public:
  /// imu: from the state to the sample's time. All sigmas of the sample [m/s] must be positive; infinite: not measured.
  VelocityFactor(StateId state, BlockKey scale, const Preintegration& imu, const SE3& T_B_S,
                 const VelocitySample& sample);
  const ceres::LossFunction* loss() const override { return &loss_; }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;
  bool marginalized_with(const std::set<BlockKey>& leaving) const override;
  std::shared_ptr<Factor> without(const DroppedState& dropped) const override;
  bool merge(const Factor& other) override;

 private:
  /// d_v v_B + d_g g_B + constant + d_bg b_g + d_ba b_a, with velocity and gravity in the state's B.
  struct PropagatedVelocity {
    Eigen::Matrix3d d_v, d_g, d_bg, d_ba;
    Eigen::Vector3d constant;

    /// This propagation from the previous state, at the other end of the IMU interval.
    PropagatedVelocity from_state_before(const Preintegration& imu) const;
    /// `share` is one number for each axis of the sensor.
    void average_with(const Eigen::Vector3d& share, const PropagatedVelocity& other);
  };

  VelocityFactor(StateId state, BlockKey scale, PropagatedVelocity propagated, const Eigen::Vector3d& measured,
                 const Eigen::Vector3d& weight);

  PropagatedVelocity propagated_;
  Eigen::Vector3d measured_;  ///< weighted mean; 0 for an axis that is not measured
  Eigen::Vector3d weight_;    ///< sum of 1 / sigma^2
  ceres::CauchyLoss loss_;
};

}  // namespace edged

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
  bool absorb(const Factor& other) override;

 private:
  /// by_velocity v_B + by_gravity g_B + off + by_gyro b_g + by_accel b_a, with velocity and gravity in the state's B.
  struct Way {
    Eigen::Matrix3d by_velocity, by_gravity, by_gyro, by_accel;
    Eigen::Vector3d off;

    /// The same, from the previous state at the other end of the IMU interval.
    Way after(const Preintegration& imu) const;
    /// share: per axis of the sensor.
    void add(const Eigen::Vector3d& share, const Way& other);
  };

  VelocityFactor(StateId state, BlockKey scale, Way way, const Eigen::Vector3d& measured,
                 const Eigen::Vector3d& weight);

  Way way_;
  Eigen::Vector3d measured_;  ///< weighted mean; 0 for an axis that is not measured
  Eigen::Vector3d weight_;    ///< sum of 1 / sigma^2
  ceres::CauchyLoss loss_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The height factor: heights of the body above a level that drifts, measured in the IMU interval after a state.
#pragma once

#include "edged/estimator/factors/factor.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// Blocks: pose and motion of the state before the samples, bias of the sensor. Residual (1): height there + bias -
/// measurement, over its sigma. The IMU propagates the state to the time of a sample (docs/math.md, X1). The residual
/// is linear in the terms that depend on the sample, so many samples merge into their weighted mean (X2). When their
/// state is dropped, they move to the state before.
class HeightFactor final : public Factor {
 public:
  /// imu: from the state to the sample's time. sigma [m].
  HeightFactor(StateId state, BlockKey bias, const Preintegration& imu, double height_m, double sigma);
  const ceres::LossFunction* loss() const override { return &loss_; }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;
  bool marginalized_with(const std::set<BlockKey>& leaving) const override;
  std::shared_ptr<Factor> without(const DroppedState& dropped) const override;
  bool merge(const Factor& other) override;

  /// The measurement minus the height of the body: the bias by these samples alone.
  double bias_at(const double* pose, const double* motion) const;

 private:
  /// Height = z + dt v_z - g half_dt2 + e_z R (d_p + d_p_d_bg b_g + d_p_d_ba b_a).
  struct PropagatedPosition {
    double dt = 0.0, half_dt2 = 0.0;
    Eigen::Vector3d d_p = Eigen::Vector3d::Zero();
    Eigen::Matrix3d d_p_d_bg = Eigen::Matrix3d::Zero(), d_p_d_ba = Eigen::Matrix3d::Zero();

    /// This propagation from the previous state, at the other end of the IMU interval.
    PropagatedPosition from_state_before(const Preintegration& imu) const;
    void average_with(double share, const PropagatedPosition& other);
    Eigen::Vector3d in_body(const double* motion) const;
  };

  HeightFactor(StateId state, BlockKey bias, PropagatedPosition propagated, double height_m, double weight);

  PropagatedPosition propagated_;
  double height_m_, weight_;  ///< weighted mean, sum of 1 / sigma^2
  ceres::CauchyLoss loss_;
};

}  // namespace edged

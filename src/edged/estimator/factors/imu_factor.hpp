// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The inertial factor between two consecutive states.
#pragma once

#include "edged/estimator/factors/factor.hpp"
#include "edged/imu/preintegration.hpp"

namespace edged {

/// Blocks: pose 0, motion 0, pose 1, motion 1, intrinsics of the IMU. Errors of scale and axes act as a bias
/// proportional to the mean rate and acceleration of the interval: exact to first order in both. Residual (15),
/// whitened: rotation, velocity, position (Forster et al. 2017, Eq. 45), then the change of gyro and accelerometer bias
/// against their random walks.
///
/// When a state is dropped, its interval is joined to the next one, which is exact.
class ImuFactor final : public Factor {
 public:
  /// The preintegration must outlive the factor.
  ImuFactor(StateId a, StateId b, const Preintegration& imu);
  /// The white noise is so many times that of the preintegration.
  void set_noise_scale(double scale) { weight_ = 1.0 / scale; }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;
  std::shared_ptr<Factor> without(const DroppedState& dropped) const override;

 private:
  /// L^-1 M for the covariance L L^T, whose random walks are independent.
  template <int Columns, int Options>
  Eigen::Matrix<double, 15, Columns, Options> whitened(const Eigen::Matrix<double, 15, Columns, Options>& M) const {
    Eigen::Matrix<double, 15, Columns, Options> white;
    white.template topRows<9>() = weight_ * whiten_motion_.lazyProduct(M.template topRows<9>());
    white.template bottomRows<6>() = whiten_biases_.asDiagonal() * M.template bottomRows<6>();
    return white;
  }

  const Preintegration& imu_;
  Matrix9d whiten_motion_;
  Vector6d whiten_biases_;
  double weight_ = 1.0;
};

}  // namespace edged

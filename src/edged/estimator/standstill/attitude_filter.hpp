// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The attitude of the body before the estimator has started: an error-state Kalman filter of gyro and accelerometer.
#pragma once

#include <optional>
#include <span>

#include "edged/imu_noise.hpp"
#include "edged/measurement.hpp"
#include "edged/state.hpp"

namespace edged {

/// Accelerations of the body are noise about gravity: their mean over seconds is small, and how large they are is
/// estimated from the innovations. The state is the rotation and the gyro bias.
class AttitudeFilter {
 public:
  explicit AttitudeFilter(const ImuNoise& noise) : noise_(noise) {}

  /// Takes the samples of one packet; the first is at the end of the packet before.
  void add(std::span<const ImuSample> imu);
  /// Attitude at the last sample; nothing before the first packet.
  const std::optional<Attitude>& attitude() const { return attitude_; }
  const Eigen::Vector3d& gyro_bias() const { return bias_; }

 private:
  void begin(const ImuSample& sample);
  void propagate(const ImuSample& from, const ImuSample& to);
  void correct(const Eigen::Vector3d& accel_W, double span_s);

  ImuNoise noise_;
  Eigen::Quaterniond R_W_B_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();  ///< [rad/s]
  Matrix6d P_ = Matrix6d::Zero();                   ///< covariance of the rotation, on the right, and the bias
  double motion_variance_ = 0.0;                    ///< variance of accelerations, per axis [m^2/s^4]
  std::optional<Attitude> attitude_;
};

}  // namespace edged

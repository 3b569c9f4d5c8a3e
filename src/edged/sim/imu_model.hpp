// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// An inertial sensor: true rates and specific force, with noise and wandering biases.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "edged/core/config.hpp"
#include "edged/core/types.hpp"
#include "edged/imu/noise.hpp"
#include "edged/sim/random.hpp"
#include "edged/sim/trajectory.hpp"

namespace edged {

struct ImuModelConfig {
  double rate_hz = 1000.0;
  double time_offset_ms = 2.4;  ///< t_imu = t_cam + time_offset
  double gyro_noise = 1.2e-4;   ///< [rad/s/sqrt(Hz)]
  double accel_noise = 4e-3;    ///< [m/s^2/sqrt(Hz)]
  double gyro_walk = 1e-5;      ///< [rad/s^2/sqrt(Hz)]
  double accel_walk = 1e-4;     ///< [m/s^3/sqrt(Hz)]
  double gyro_bias = 0.012;     ///< length of each constant bias, its direction is random [rad/s]
  double accel_bias = 0.1;      ///< [m/s^2]

  void visit(ConfigFields& fields);

  /// What a calibration of this sensor would say; no density is below a millionth of the default one.
  ImuNoise noise() const;
};

class ImuModel {
 public:
  ImuModel(const ImuModelConfig& config, std::uint64_t seed);

  /// One sample (Forster 2017, Eq. 27, 28); the biases walk one sample period after it.
  ImuSample measure(Timestamp t, const Kinematics& truth);

  const Eigen::Vector3d& bias_gyro() const { return bias_gyro_; }
  const Eigen::Vector3d& bias_accel() const { return bias_accel_; }

 private:
  ImuModelConfig config_;
  Random random_;
  Eigen::Vector3d bias_gyro_, bias_accel_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// An inertial sensor: true rates and specific force, with noise, bias random walks, vibration and a limited range.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "edged/imu_noise.hpp"
#include "edged/measurement.hpp"
#include "edged/sim/motion/trajectory.hpp"
#include "edged/sim/random.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

/// Noise around one frequency: white noise through a resonator of 6 Hz, of unit variance.
class NarrowbandNoise {
 public:
  NarrowbandNoise(double hz, double rate_hz);
  double next(Random& random);

 private:
  double a_1_, a_2_, drive_;
  double last_ = 0.0, before_ = 0.0;
};

class ImuModel {
 public:
  ImuModel(const ImuModelConfig& config, std::uint64_t seed);

  /// One sample (Forster 2017, Eq. 27, 28). Afterwards, the biases change by the walk of one period. The samples are
  /// assumed to have the rate rate_hz.
  ImuSample measure(Timestamp t, const Kinematics& truth);

  const Eigen::Vector3d& bias_gyro() const { return bias_gyro_; }
  const Eigen::Vector3d& bias_accel() const { return bias_accel_; }

 private:
  /// Adds the vibration of the motors, scaled by their speed.
  void shake(ImuSample& sample);

  ImuModelConfig config_;
  Random random_, vibration_;
  std::array<NarrowbandNoise, 12> vibrations_;  // gyroscope, accelerometer; one and twice the frequency
  Eigen::Vector3d bias_gyro_, bias_accel_;
  Eigen::Matrix3d gyro_axes_, accel_axes_;  // measurement matrix: scale and axis errors
};

}  // namespace edged

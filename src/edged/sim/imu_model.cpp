// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/imu_model.hpp"

#include <algorithm>
#include <cmath>

namespace edged {

void ImuModelConfig::visit(ConfigFields& fields) {
  fields.add("rate_hz", rate_hz, {"Hz", 10, 10000, "samples per second"});
  fields.add("time_offset_ms", time_offset_ms, {"ms", -1000, 1000, "t_imu = t_cam + time_offset"});
  fields.add("gyro_noise", gyro_noise, {"rad/s/sqrt(Hz)", 0, 1, "white noise of the gyroscope"});
  fields.add("accel_noise", accel_noise, {"m/s^2/sqrt(Hz)", 0, 10, "white noise of the accelerometer"});
  fields.add("gyro_walk", gyro_walk, {"rad/s^2/sqrt(Hz)", 0, 1, "random walk of the gyroscope's bias"});
  fields.add("accel_walk", accel_walk, {"m/s^3/sqrt(Hz)", 0, 10, "random walk of the accelerometer's bias"});
  fields.add("gyro_bias", gyro_bias, {"rad/s", 0, 10, "length of the gyroscope's bias at the start"});
  fields.add("accel_bias", accel_bias, {"m/s^2", 0, 100, "length of the accelerometer's bias at the start"});
}

ImuNoise ImuModelConfig::noise() const {
  ImuNoise noise;
  noise.gyro_noise = std::max(gyro_noise, 1e-6 * noise.gyro_noise);
  noise.accel_noise = std::max(accel_noise, 1e-6 * noise.accel_noise);
  noise.gyro_walk = std::max(gyro_walk, 1e-6 * noise.gyro_walk);
  noise.accel_walk = std::max(accel_walk, 1e-6 * noise.accel_walk);
  return noise;
}

ImuModel::ImuModel(const ImuModelConfig& config, std::uint64_t seed) : config_(config), random_(seed, 5) {
  bias_gyro_ = config.gyro_bias * random_.normal3().normalized();
  bias_accel_ = config.accel_bias * random_.normal3().normalized();
}

ImuSample ImuModel::measure(Timestamp t, const Kinematics& truth) {
  const double root_rate = std::sqrt(config_.rate_hz);
  ImuSample sample;
  sample.t = t;
  sample.gyro_B = truth.omega_B + bias_gyro_ + config_.gyro_noise * root_rate * random_.normal3();
  sample.accel_B = truth.T_W_B.rotation().conjugate() * (truth.a_W - kGravity_W) + bias_accel_ +
                   config_.accel_noise * root_rate * random_.normal3();
  bias_gyro_ += config_.gyro_walk / root_rate * random_.normal3();
  bias_accel_ += config_.accel_walk / root_rate * random_.normal3();
  return sample;
}

}  // namespace edged

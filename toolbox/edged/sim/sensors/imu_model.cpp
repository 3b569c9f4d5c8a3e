// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/imu_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace edged {
namespace {

constexpr double kBandwidth_hz = 6.0;
constexpr double kSpinUp_s = 0.4;

std::array<NarrowbandNoise, 12> make_vibrations(const ImuModelConfig& config) {
  const NarrowbandNoise one(config.vibration_hz, config.rate_hz), twice(2.0 * config.vibration_hz, config.rate_hz);
  return {one, one, one, one, one, one, twice, twice, twice, twice, twice, twice};
}

}  // namespace

NarrowbandNoise::NarrowbandNoise(double hz, double rate_hz) {
  const double radius = std::exp(-std::numbers::pi * kBandwidth_hz / rate_hz);
  a_1_ = 2.0 * radius * std::cos(2.0 * std::numbers::pi * hz / rate_hz);
  a_2_ = radius * radius;
  // Variance of x_k = a_1 x_(k-1) - a_2 x_(k-2) + e for unit variance of e.
  const double variance = (1.0 + a_2_) / ((1.0 - a_2_) * ((1.0 + a_2_) * (1.0 + a_2_) - a_1_ * a_1_));
  drive_ = 1.0 / std::sqrt(variance);
}

double NarrowbandNoise::next(Random& random) {
  const double x = a_1_ * last_ - a_2_ * before_ + drive_ * random.normal();
  before_ = last_, last_ = x;
  return x;
}

void ImuModelConfig::visit(ConfigFields& fields) {
  fields.add("rate_hz", rate_hz, {"Hz", 10, 10000, "samples per second"});
  fields.add("time_offset_ms", time_offset_ms, {"ms", -1000, 1000, "t_imu = t_cam + time_offset"});
  fields.add("gyro_noise", gyro_noise, {"rad/s/sqrt(Hz)", 0, 1, "white noise of the gyroscope"});
  fields.add("accel_noise", accel_noise, {"m/s^2/sqrt(Hz)", 0, 10, "white noise of the accelerometer"});
  fields.add("gyro_walk", gyro_walk, {"rad/s^2/sqrt(Hz)", 0, 1, "random walk of the gyroscope's bias"});
  fields.add("accel_walk", accel_walk, {"m/s^3/sqrt(Hz)", 0, 10, "random walk of the accelerometer's bias"});
  fields.add("gyro_bias", gyro_bias, {"rad/s", 0, 10, "length of the gyroscope's bias at the start"});
  fields.add("accel_bias", accel_bias, {"m/s^2", 0, 100, "length of the accelerometer's bias at the start"});
  fields.add("scale_error", scale_error, {"1", 0, 0.2, "spread of the scales of gyroscope and accelerometer about 1"});
  fields.add("cross_axis_mrad", cross_axis_mrad, {"mrad", 0, 200, "spread of the cross-axis sensitivity"});
  fields.add("gyro_range", gyro_range, {"rad/s", 0.1, 1000, "the gyroscope reads no more than this"});
  fields.add("accel_range", accel_range, {"m/s^2", 10, 10000, "the accelerometer reads no more than this"});
  fields.add("vibration_hz", vibration_hz, {"Hz", 1, 5000, "speed of the motors"});
  fields.add("gyro_vibration", gyro_vibration, {"rad/s", 0, 10, "rms of the vibration around that frequency"});
  fields.add("accel_vibration", accel_vibration, {"m/s^2", 0, 100, "rms of the vibration around that frequency"});
  fields.add("gyro_broadband", gyro_broadband, {"rad/s/sqrt(Hz)", 0, 1, "vibration over all frequencies"});
  fields.add("accel_broadband", accel_broadband, {"m/s^2/sqrt(Hz)", 0, 10, "vibration over all frequencies"});
  fields.add("motors_on_s", motors_on_s, {"s", 0, 1e6, "vibration begins"});
  fields.add("motors_off_s", motors_off_s, {"s", 0, 1e6, "vibration ends"});
}

ImuNoise ImuModelConfig::noise() const {
  ImuNoise noise;
  noise.gyro_noise = std::max(std::hypot(gyro_noise, gyro_broadband), 1e-6 * noise.gyro_noise);
  noise.accel_noise = std::max(std::hypot(accel_noise, accel_broadband), 1e-6 * noise.accel_noise);
  noise.gyro_walk = std::max(gyro_walk, 1e-6 * noise.gyro_walk);
  noise.accel_walk = std::max(accel_walk, 1e-6 * noise.accel_walk);
  noise.gyro_saturation = gyro_range;
  noise.accel_saturation = accel_range;
  return noise;
}

ImuModel::ImuModel(const ImuModelConfig& config, std::uint64_t seed)
    : config_(config), random_(seed, 5), vibration_(seed, 8), vibrations_(make_vibrations(config)) {
  bias_gyro_ = config.gyro_bias * random_.normal3().normalized();
  bias_accel_ = config.accel_bias * random_.normal3().normalized();
  Random axes(seed, 10);
  for (Eigen::Matrix3d* of_sensor : {&gyro_axes_, &accel_axes_}) {
    for (int i = 0; i < 9; ++i) {
      const bool own = i % 4 == 0;
      (*of_sensor)(i / 3, i % 3) =
          (own ? 1.0 : 0.0) + (own ? config.scale_error : 1e-3 * config.cross_axis_mrad) * axes.normal();
    }
  }
}

ImuSample ImuModel::measure(Timestamp t, const Kinematics& truth) {
  const double root_rate = std::sqrt(config_.rate_hz);
  ImuSample sample;
  sample.t = t;
  sample.gyro_B = gyro_axes_ * truth.omega_B + bias_gyro_ + config_.gyro_noise * root_rate * random_.normal3();
  sample.accel_B = accel_axes_ * (truth.T_W_B.rotation().conjugate() * (truth.a_W - kGravity_W)) + bias_accel_ +
                   config_.accel_noise * root_rate * random_.normal3();
  shake(sample);
  const auto limit = [](const Eigen::Vector3d& v, double range) { return v.cwiseMax(-range).cwiseMin(range).eval(); };
  sample.gyro_B = limit(sample.gyro_B, config_.gyro_range);
  sample.accel_B = limit(sample.accel_B, config_.accel_range);
  bias_gyro_ += config_.gyro_walk / root_rate * random_.normal3();
  bias_accel_ += config_.accel_walk / root_rate * random_.normal3();
  return sample;
}

void ImuModel::shake(ImuSample& sample) {
  if (config_.gyro_vibration + config_.accel_vibration + config_.gyro_broadband + config_.accel_broadband == 0.0)
    return;
  const double t_cam_s = to_seconds(sample.t) - 1e-3 * config_.time_offset_ms;
  const double level = std::clamp((t_cam_s - config_.motors_on_s) / kSpinUp_s, 0.0, 1.0) *
                       std::clamp((config_.motors_off_s - t_cam_s) / kSpinUp_s, 0.0, 1.0);
  const double root_rate = std::sqrt(config_.rate_hz);
  for (int i = 0; i < 3; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const double gyro = vibrations_[k].next(vibration_) + 0.5 * vibrations_[k + 6].next(vibration_);
    const double accel = vibrations_[k + 3].next(vibration_) + 0.5 * vibrations_[k + 9].next(vibration_);
    sample.gyro_B[i] +=
        level * (config_.gyro_vibration * gyro + config_.gyro_broadband * root_rate * vibration_.normal());
    sample.accel_B[i] +=
        level * (config_.accel_vibration * accel + config_.accel_broadband * root_rate * vibration_.normal());
  }
}

}  // namespace edged

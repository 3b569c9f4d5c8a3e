// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/imu_noise.hpp"

#include <cmath>
#include <string_view>

#include "edged/core/check.hpp"

namespace edged {

void ImuNoise::validate() const {
  const auto need = [](bool right, std::string_view name, double value, std::string_view must) {
    if (!right) throw InputError::format("IMU noise: {} is {}, must be {}", name, value, must);
  };
  const auto density = [&](std::string_view name, double value) {
    need(value > 0.0 && std::isfinite(value), name, value, "above zero and finite: take it from the data sheet");
  };
  density("gyro_noise", gyro_noise);
  density("accel_noise", accel_noise);
  density("gyro_walk", gyro_walk);
  density("accel_walk", accel_walk);
  need(gyro_saturation > 0.0, "gyro_saturation", gyro_saturation, "above zero: the range of the gyro [rad/s]");
  need(accel_saturation > 0.0, "accel_saturation", accel_saturation,
       "above zero: the range of the accelerometer [m/s^2]");
  need(saturation_inflation >= 1.0 && std::isfinite(saturation_inflation), "saturation_inflation", saturation_inflation,
       "at least 1 and finite: leave it at its default");
}

}  // namespace edged

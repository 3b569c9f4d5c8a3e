// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/imu_noise.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "edged/core/check.hpp"

namespace edged {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(ImuNoise, WhatCannotBeIsRefusedByItsName) {
  const std::pair<const char*, double ImuNoise::*> values[] = {
      {"gyro_noise", &ImuNoise::gyro_noise},
      {"accel_noise", &ImuNoise::accel_noise},
      {"gyro_walk", &ImuNoise::gyro_walk},
      {"accel_walk", &ImuNoise::accel_walk},
      {"gyro_saturation", &ImuNoise::gyro_saturation},
      {"accel_saturation", &ImuNoise::accel_saturation},
      {"saturation_inflation", &ImuNoise::saturation_inflation}};
  for (const auto& [name, value] : values) {
    for (const double wrong : {0.0, -1e-3, std::numeric_limits<double>::quiet_NaN()}) {
      ImuNoise noise;
      noise.*value = wrong;
      EXPECT_THAT([&] { noise.validate(); }, ThrowsMessage<InputError>(HasSubstr(std::string(name) + " is ")));
    }
  }
}

TEST(ImuNoise, ASensorThatNeverSaturatesIsFine) {
  ImuNoise noise;
  noise.gyro_saturation = noise.accel_saturation = std::numeric_limits<double>::infinity();
  EXPECT_NO_THROW(noise.validate());
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The estimator with an IMU that shakes: its noise is not the calibrated one.
#include <gtest/gtest.h>

#include "edged/estimator/estimator.hpp"
#include "edged/estimator/test_world.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

/// A packet of an IMU that is known to be so many times as noisy as calibrated.
EstimatorInput shaking_packet(TestWorld& world, double t, double times) {
  EstimatorInput input = world.packet(t, kPacket_s, std::lround(t / kPacket_s) % 4 == 0);
  ImuNoise known = world.noise();
  known.accel_noise *= times, known.gyro_noise *= times;
  input.motion = Preintegration(input.motion.samples(), {0, 0, 0}, {0, 0, 0}, known);
  return input;
}

TEST(ShakingImu, HasTheNoiseRaisedUntilItExplainsTheResiduals) {
  TestWorld world({.rest_s = 1.5, .pixel_noise = 0.2, .imu_noise = 50.0});
  Estimator estimator(world.rig(), world.noise(), EstimatorConfig());
  double strain = 0.0, scale = 1.0;
  for (double t = kPacket_s; t < 6.0; t += kPacket_s) {
    strain = std::max(strain, estimator.add(shaking_packet(world, t, t < 1.5 ? 50.0 : 10.0)).imu_strain);
    scale = std::max(scale, estimator.window().imu_noise_scale());
  }
  ASSERT_TRUE(estimator.initialized());
  EXPECT_LT(strain, 0.5);
  EXPECT_GT(scale, 2.0);
}

TEST(ShakingImu, KeepsItsNoiseWhereItIsCalm) {
  TestWorld world({.rest_s = 1.0, .imu_noise = 5.0});
  Estimator estimator(world.rig(), world.noise(), EstimatorConfig());
  for (int i = 1; i * kPacket_s < 4.0; ++i) {
    estimator.add(world.packet(i * kPacket_s, kPacket_s, i % 4 == 0));
    EXPECT_EQ(estimator.window().imu_noise_scale(), 1.0);
  }
}

TEST(ShakingImu, StartsAtRestOnceItsNoiseIsMeasured) {
  TestWorld world({.rest_s = 3.0, .pixel_noise = 0.2, .imu_noise = 10.0});
  Estimator estimator(world.rig(), world.noise(), EstimatorConfig());
  double t = kPacket_s;
  for (; !estimator.initialized() && t < 3.0; t += kPacket_s) estimator.add(shaking_packet(world, t, 10.0));
  EXPECT_TRUE(estimator.initialized());
  EXPECT_GT(t, to_seconds(kInitializationTuning.noise_measured));
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/imu/noise_estimator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace edged {
namespace {

using Eigen::Vector3d;

constexpr ImuNoise kCalibrated{.gyro_noise = 2e-4, .accel_noise = 5e-3};
constexpr double kPacket_s = 0.05;

/// An IMU that follows a motion with white noise of given densities, and vibration.
struct Imu {
  double rate_hz = 500.0;
  double gyro_noise = kCalibrated.gyro_noise, accel_noise = kCalibrated.accel_noise;
  std::function<Vector3d(double)> accel = [](double) { return Vector3d(0, 0, 9.81); };
  double t = 0.0;
  std::mt19937_64 random{5};

  Vector3d noise(double density) {
    const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 * 2.0 - 1.0; };
    return density * std::sqrt(3.0 * rate_hz) * Vector3d(uniform(), uniform(), uniform());  // of that variance
  }

  std::vector<ImuSample> packet() {
    std::vector<ImuSample> samples;
    const double end = t + kPacket_s;
    const auto at = [&](double s) {
      return ImuSample{timestamp_from_seconds(s), noise(gyro_noise), accel(s) + noise(accel_noise)};
    };
    samples.push_back(at(t - 0.3 / rate_hz));  // the ends are no readings
    for (; t < end - 1e-9; t += 1.0 / rate_hz) samples.push_back(at(t));
    samples.push_back(at(t - 0.3 / rate_hz));
    return samples;
  }
};

ImuNoise found_after(Imu imu, double duration_s) {
  ImuNoiseEstimator estimator(kCalibrated);
  ImuNoise found;
  for (double s = 0.0; s < duration_s; s += kPacket_s) found = estimator.add(imu.packet());
  return found;
}

TEST(ImuNoiseEstimator, KeepsTheCalibratedNoiseWhereItIsRight) {
  for (const double rate_hz : {100.0, 200.0, 500.0, 1000.0}) {
    const ImuNoise found = found_after({.rate_hz = rate_hz}, 3.0);
    EXPECT_EQ(found.gyro_noise, kCalibrated.gyro_noise) << rate_hz;
    EXPECT_EQ(found.accel_noise, kCalibrated.accel_noise) << rate_hz;
  }
}

TEST(ImuNoiseEstimator, TakesNoMotionForNoise) {
  for (const double rate_hz : {100.0, 200.0, 1000.0}) {
    Imu imu{.rate_hz = rate_hz};
    imu.accel = [](double t) { return Vector3d(6.0 * std::sin(12.0 * t), 4.0 * std::sin(9.0 * t), 9.81); };
    EXPECT_EQ(found_after(imu, 3.0).accel_noise, kCalibrated.accel_noise) << rate_hz;
  }
}

TEST(ImuNoiseEstimator, FindsWhiteNoiseAtAnyRate) {
  for (const double rate_hz : {100.0, 200.0, 500.0, 1000.0}) {
    const ImuNoise found = found_after({.rate_hz = rate_hz, .gyro_noise = 2e-3, .accel_noise = 0.05}, 3.0);
    EXPECT_NEAR(found.gyro_noise, 2e-3, 0.8e-3) << rate_hz;
    EXPECT_NEAR(found.accel_noise, 0.05, 0.02) << rate_hz;
  }
}

/// A steady tone cancels in the integral, however strong it is.
TEST(ImuNoiseEstimator, CountsOnlyWhatTheIntegralSees) {
  Imu imu{.rate_hz = 1000.0};
  imu.accel = [](double t) { return Vector3d(2.0 * std::sin(820.0 * t), 0, 9.81); };
  EXPECT_LT(found_after(imu, 3.0).accel_noise, 2.0 * kCalibrated.accel_noise);
}

TEST(ImuNoiseEstimator, ForgetsMotorsAKnockAndGaps) {
  Imu imu{.gyro_noise = 2e-3};
  ImuNoiseEstimator estimator(kCalibrated);
  for (int i = 0; i < 39; ++i) estimator.add(imu.packet());
  EXPECT_GT(estimator.add(imu.packet()).gyro_noise, 1e-3);
  imu.gyro_noise = kCalibrated.gyro_noise;
  for (int i = 0; i < 23; ++i) estimator.add(imu.packet());
  EXPECT_EQ(estimator.add(imu.packet()).gyro_noise, kCalibrated.gyro_noise);
  imu.accel = [](double t) -> Vector3d { return {0.0, 20.0 * std::sin(700.0 * t), 9.81}; };
  estimator.add(imu.packet());
  imu.accel = [](double) { return Vector3d(0, 0, 9.81); };
  for (int i = 0; i < 5; ++i) EXPECT_EQ(estimator.add(imu.packet()).accel_noise, kCalibrated.accel_noise);
  imu.gyro_noise = 2e-3;
  for (int i = 0; i < 40; ++i) estimator.add(imu.packet());
  imu.t += 1.0;
  EXPECT_EQ(estimator.add(imu.packet()).gyro_noise, kCalibrated.gyro_noise) << "too few samples to tell";
}

/// All samples so far of an IMU.
std::vector<ImuSample> samples_of(Imu imu, double duration_s) {
  std::vector<ImuSample> samples;
  for (double s = 0.0; s < duration_s; s += kPacket_s) {
    const std::vector<ImuSample> packet = imu.packet();
    samples.insert(samples.end(), packet.begin() + 1, packet.end() - 1);
  }
  return samples;
}

TEST(NoiseAtRest, IsTheCalibratedOneWhereThatIsRight) {
  for (const double rate_hz : {100.0, 200.0, 1000.0}) {
    const ImuNoise found = noise_at_rest(samples_of({.rate_hz = rate_hz}, 1.0), kCalibrated);
    EXPECT_EQ(found.gyro_noise, kCalibrated.gyro_noise) << rate_hz;
    EXPECT_EQ(found.accel_noise, kCalibrated.accel_noise) << rate_hz;
  }
}

TEST(NoiseAtRest, FindsWhiteNoiseAndSlowOscillations) {
  const ImuNoise white = noise_at_rest(samples_of({.rate_hz = 200.0, .gyro_noise = 2e-3}, 2.0), kCalibrated);
  EXPECT_NEAR(white.gyro_noise, 2e-3, 0.8e-3);
  Imu imu{.rate_hz = 100.0};
  imu.accel = [](double t) { return Vector3d(std::sin(20.0 * t), std::cos(20.0 * t), 9.81 + std::sin(17.0 * t)); };
  EXPECT_GT(noise_at_rest(samples_of(imu, 1.0), kCalibrated).accel_noise, 0.1);
  EXPECT_EQ(found_after(imu, 3.0).accel_noise, kCalibrated.accel_noise) << "in flight that may be motion";
}

TEST(NoiseAtRest, HoldsUntilTheNextRest) {
  Imu imu;
  ImuNoiseEstimator estimator(kCalibrated);
  estimator.set_least({.gyro_noise = 0.02, .accel_noise = 0.3});
  EXPECT_EQ(estimator.add(imu.packet()).accel_noise, 0.3);
  estimator.set_least(kCalibrated);
  EXPECT_EQ(estimator.add(imu.packet()).accel_noise, kCalibrated.accel_noise);
}

/// The noise after two seconds in which each update has changed the velocity by so much.
ImuNoise found_with_corrections(double accel_noise, double dv) {
  Imu imu{.gyro_noise = 10.0 * kCalibrated.gyro_noise, .accel_noise = accel_noise};
  ImuNoiseEstimator estimator(kCalibrated);
  ImuNoise found;
  for (int i = 0; i < 40; ++i) {
    found = estimator.add(imu.packet());
    estimator.add_correction(timestamp_from_seconds(imu.t), Vector3d(dv, -dv, dv), kPacket_s);
  }
  return found;
}

TEST(ImuNoiseEstimator, GrowsWithTheChangesOfTheVelocityWhereTheImuShakes) {
  const double shaking = 0.05, as_expected = shaking * std::sqrt(kPacket_s);
  EXPECT_NEAR(found_with_corrections(shaking, as_expected).accel_noise, shaking, 0.02);
  const ImuNoise grown = found_with_corrections(shaking, 4.0 * as_expected);
  EXPECT_NEAR(grown.accel_noise, 4.0 * shaking, 1.2 * shaking);
  EXPECT_NEAR(grown.gyro_noise, 40.0 * kCalibrated.gyro_noise, 16.0 * kCalibrated.gyro_noise);
  EXPECT_EQ(found_with_corrections(kCalibrated.accel_noise, 0.1).accel_noise, kCalibrated.accel_noise)
      << "dynamic objects change it, too";
}

}  // namespace
}  // namespace edged

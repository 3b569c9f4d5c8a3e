// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Analytic turns against a gyro whose clock has an epoch of its own, and drifts.
#include "edged/checks/agreement/imu_offset.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "edged/checks/agreement/test_motion.hpp"

namespace edged {
namespace {

using Rate = std::function<Eigen::Vector3d(double)>;  ///< angular velocity of the body [rad/s] by time [s]

/// Samples at 400 Hz from `begin_s` on by the camera's clock, with stamps t_imu = t_imu_0 + rate * (t - begin_s).
std::vector<ImuSample> samples_of(const Rate& rate, double begin_s, double end_s, double first_stamp_s,
                                  double speed = 1.0) {
  std::vector<ImuSample> samples;
  for (double t = begin_s; t < end_s; t += 0.0025)
    samples.push_back({.t = timestamp_from_seconds(first_stamp_s + speed * (t - begin_s)),
                       .gyro_B = rate(t),
                       .accel_B = {0, 0, 9.81}});
  return samples;
}

const SE3 kAgainstImu(so3::exp({0.3, -1.2, 2.0}), Eigen::Vector3d::Zero());

/// Turns of 80 ms at 25 Hz in pieces of 20 s, with noise of 1 mrad each axis.
std::vector<std::vector<Turn>> pieces_of(const Rate& rate, double seconds) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0.0, 1e-3);
  std::vector<std::vector<Turn>> pieces;
  for (double t = 0.0; t < seconds - 0.2; t += 0.04) {
    Eigen::Vector3d phi = Eigen::Vector3d::Zero();
    for (int i = 0; i < 20; ++i) phi += rate(t + (i + 0.5) * 0.004) * 0.004;
    for (double& axis : phi) axis += normal(random);
    if (static_cast<std::size_t>(t / 20.0) >= pieces.size()) pieces.emplace_back();
    pieces.back().push_back(
        {timestamp_from_seconds(t), timestamp_from_seconds(t + 0.08), kAgainstImu.R().transpose() * phi});
  }
  return pieces;
}

RigCamera camera(double time_offset_s = 0.0) {
  return {"frames", Modality::Frames, {}, kAgainstImu, duration_from_seconds(time_offset_s)};
}

TEST(ImuOffset, FindsAnyOffset) {
  const auto pieces = pieces_of(uneven, 20);
  for (const double offset_s : {-0.15, 1.0, -10.0, 1000.0, -1.7e9})
    for (const bool has_extrinsics : {true, false}) {
      const auto found = find_imu_offset(pieces, samples_of(uneven, 0.0, 20.0, -offset_s), camera(), has_extrinsics);
      ASSERT_TRUE(found.determined()) << offset_s;
      EXPECT_NEAR(to_seconds(found.offset), offset_s, 3e-4);
      EXPECT_NEAR(to_seconds(found.offset), offset_s, 4 * found.sigma_s);
      EXPECT_LT(found.match->next_correlation, 0.7);
    }
}

TEST(ImuOffset, LeavesTheTimeOffsetOfTheCameraToTheCalibration) {
  // Stamps of the IMU are 5 s behind, those of the camera 20 ms: t_imu = t_cam + 0.02.
  const Rate delayed = [](double t) { return uneven(t + 0.02); };
  const auto found = find_imu_offset(pieces_of(delayed, 20), samples_of(uneven, 0.0, 20.0, -5.0), camera(0.02), true);
  ASSERT_TRUE(found.determined());
  EXPECT_NEAR(to_seconds(found.offset), 5.0, 3e-4);
}

TEST(ImuOffset, NeedsOnlyAPartOfTheRecordingInCommon) {
  const auto late = samples_of(uneven, 9.0, 60.0, 3.0);  // the first sample was at 9 s
  const auto found = find_imu_offset(pieces_of(uneven, 20), late, camera(), true);
  ASSERT_TRUE(found.determined());
  EXPECT_NEAR(to_seconds(found.offset), 6.0, 5e-4);
  EXPECT_NEAR(to_seconds(found.match->overlap), 11.0, 0.3);
}

TEST(ImuOffset, FindsADriftInALongRecordingAndSaysThatAShortOneIsTooShort) {
  for (const double ppm : {50.0, 0.0, -50.0}) {
    const auto found =
        find_imu_offset(pieces_of(uneven, 240), samples_of(uneven, 0.0, 240.0, 77.0, 1 + 1e-6 * ppm), camera(), true);
    ASSERT_TRUE(found.determined());
    ASSERT_TRUE(found.rate_sigma);
    EXPECT_LT(*found.rate_sigma, 5e-6);
    EXPECT_NEAR(1e6 * (found.rate - 1.0), ppm, 5.0);
    EXPECT_NEAR(to_seconds(found.offset), -77.0, 1e-3);
  }
  const auto found =
      find_imu_offset(pieces_of(uneven, 20), samples_of(uneven, 0.0, 20.0, 77.0, 1.00005), camera(), true);
  ASSERT_TRUE(found.determined());
  EXPECT_FALSE(found.rate_sigma);
  EXPECT_EQ(found.rate, 1.0);
  EXPECT_NEAR(to_seconds(found.offset), -77.0, 1e-3) << "half of what it drifts";
}

TEST(ImuOffset, IsNotDeterminedByRotationThatIsTheSameAtOtherTimes) {
  const Rate still = [](double) { return Eigen::Vector3d::Zero().eval(); };
  const Rate steady = [](double) { return Eigen::Vector3d(0.1, 0.7, -0.2); };
  const Rate swinging = [](double t) { return Eigen::Vector3d(0.5 * std::sin(2 * M_PI * t), 0, 0.2); };
  for (const Rate& rate : {still, steady, swinging})
    for (const bool has_extrinsics : {true, false})
      EXPECT_FALSE(find_imu_offset(pieces_of(rate, 30), samples_of(rate, 0.0, 30.0, 4.0), camera(), has_extrinsics)
                       .determined());
  const Rate other = [](double t) { return uneven(t + 500.0); };
  EXPECT_FALSE(find_imu_offset(pieces_of(uneven, 30), samples_of(other, 0.0, 30.0, 4.0), camera(), true).determined());
}

TEST(ImuOffset, SaysNothingWithoutTurnsOrSamples) {
  EXPECT_FALSE(find_imu_offset({}, samples_of(uneven, 0.0, 20.0, 4.0), camera(), true).match);
  EXPECT_FALSE(find_imu_offset(pieces_of(uneven, 20), {}, camera(), true).match);
  EXPECT_FALSE(find_imu_offset(pieces_of(uneven, 2), samples_of(uneven, 0.0, 2.0, 4.0), camera(), true).match);
}

}  // namespace
}  // namespace edged

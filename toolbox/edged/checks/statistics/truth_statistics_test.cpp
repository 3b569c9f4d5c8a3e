// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/truth_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace edged {
namespace {

constexpr std::size_t kFirst = 800, kWrong = 300;  // poses

/// Two seconds at rest, then motion in all axes, at 200 Hz, with the noise of motion capture.
Trajectory moving(double noise = 0.0) {
  std::mt19937 random(1);
  std::normal_distribution<double> error(0.0, noise > 0.0 ? noise : 1.0);
  Trajectory poses;
  for (int i = 0; i < 2000; ++i) {
    const double s = std::pow(std::max(0.0, 0.005 * i - 2.0), 2) / 8;
    Eigen::Vector3d p(std::sin(s), std::cos(s), 0.3 * std::sin(2 * s)), phi(0.4 * std::sin(s), 0.3 * s, 0.0);
    if (noise > 0.0)
      for (Eigen::Vector3d* v : {&p, &phi})
        for (double& x : *v) x += error(random);
    poses.push_back({timestamp_from_seconds(0.005 * i), SE3(so3::exp(phi), p)});
  }
  return poses;
}

template <typename Change>
TruthStatistics with(const Change& change, double noise = 0.0) {
  Trajectory poses = moving(noise);
  const SE3 held = poses[kFirst].T;
  for (std::size_t i = kFirst; i < kFirst + kWrong; ++i) change(i, held, poses[i].T);
  return truth_statistics({poses, "body"});
}

TEST(TruthStatistics, FindNothingInRestMotionAndTheNoiseOfMotionCapture) {
  for (const double noise : {0.0, 1e-4, 1e-3}) {
    const TruthStatistics s = with([](std::size_t, const SE3&, SE3&) {}, noise);
    EXPECT_EQ(s.jumps, 0U) << noise;
    EXPECT_EQ(s.frozen, Duration(0)) << noise;
  }
}

TEST(TruthStatistics, FindNothingInPosesOfOneASecond) {
  Trajectory sparse;
  for (std::size_t i = 0; const StampedPose& pose : moving())
    if (i++ % 200 == 0) sparse.push_back(pose);
  EXPECT_EQ(truth_statistics({sparse, "body"}).jumps, 0U);
}

TEST(TruthStatistics, FindAPoseThatIsHeldInMotion) {
  const auto hold = [](std::size_t, const SE3& held, SE3& T) { T = held; };
  for (const double noise : {0.0, 1e-3}) {
    const TruthStatistics s = with(hold, noise);
    EXPECT_EQ(s.frozen_since, timestamp_from_seconds(0.005 * kFirst));
    EXPECT_NEAR(to_seconds(s.frozen), 0.005 * kWrong, 0.006);
  }
  Trajectory poses = moving();
  for (std::size_t i = kFirst; i < poses.size(); ++i) poses[i].T = poses[kFirst].T;
  EXPECT_EQ(truth_statistics({poses, "body"}).frozen_since, timestamp_from_seconds(0.005 * kFirst)) << "to the end";
}

TEST(TruthStatistics, FindFlipsZerosAndMillimetres) {
  const auto flip = [](std::size_t, const SE3&, SE3& T) { T = T * SE3(so3::exp({0, 0, 0.6}), {0.1, 0, 0}); };
  const auto zero = [](std::size_t, const SE3&, SE3& T) { T = SE3(); };
  const auto millimetres = [](std::size_t, const SE3&, SE3& T) { T = SE3(T.rotation(), 1000 * T.translation()); };
  const auto one = [](std::size_t i, const SE3&, SE3& T) {
    if (i == kFirst) T = T * SE3(so3::exp({0, 0, 0.6}), {0, 0, 0});
  };
  for (const TruthStatistics& s : {with(flip, 1e-4), with(zero, 1e-4), with(millimetres, 1e-4), with(one, 1e-4)}) {
    EXPECT_EQ(s.jumps, 2U);
    EXPECT_EQ(s.first_jump.t, timestamp_from_seconds(0.005 * kFirst));
  }
  EXPECT_NEAR(with(flip).first_jump.angle_rad, 0.6, 0.01);
}

}  // namespace
}  // namespace edged

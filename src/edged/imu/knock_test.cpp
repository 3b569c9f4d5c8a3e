// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "edged/imu/preintegration.hpp"

namespace edged {
namespace {

using Eigen::Vector3d;

TEST(Preintegration, KnowsLessAfterAKnockThanItsNoiseSays) {
  const auto velocity_sigma = [](double knock) {
    std::vector<ImuSample> samples;
    for (int i = 0; i <= 20; ++i) {
      const double ring = i == 10 ? knock : i == 11 ? -0.5 * knock : 0.0;
      samples.push_back({Timestamp(std::chrono::milliseconds(5 * i)), Vector3d::Zero(), Vector3d(0, 0, 9.81 + ring)});
    }
    return std::sqrt(Preintegration(samples, Vector3d::Zero(), Vector3d::Zero(), ImuNoise{}).covariance()(5, 5));
  };
  EXPECT_EQ(velocity_sigma(1.0), velocity_sigma(0.0));  // as any flight has
  // 3 g for 5 ms may be off by a third of a step of them: 0.05 m/s.
  EXPECT_GT(velocity_sigma(30.0), 0.05);
  EXPECT_LT(velocity_sigma(30.0), 0.2);
}

}  // namespace
}  // namespace edged

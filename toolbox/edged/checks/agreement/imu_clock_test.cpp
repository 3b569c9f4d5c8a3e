// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Analytic turns against a gyro whose clock runs at another rate.
#include "edged/checks/agreement/imu_clock.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace edged {
namespace {

/// Angular velocity of a body that is held in a hand [rad/s].
Eigen::Vector3d swaying(double t) {
  return {0.8 * std::sin(3 * t), 0.6 * std::sin(4.1 * t + 1) * std::sin(0.7 * t), 0.5 * std::cos(2.3 * t)};
}

TEST(ImuClock, FindsTheRateOfAnotherClockAndNothingWhereItIsRight) {
  constexpr double kSeconds = 8.0;
  std::vector<Turn> turns;
  for (double t = 0.1; t < kSeconds - 0.2; t += 0.04) {
    const Eigen::Vector3d phi =
        0.08 * swaying(t + 0.04) + 0.002 * Eigen::Vector3d(std::sin(97 * t), std::cos(89 * t), 0);
    turns.push_back({timestamp_from_seconds(t), timestamp_from_seconds(t + 0.08), phi});
  }
  for (const double rate : {1.0, 0.5, 2.0, 1.02, 0.97, 3.0}) {
    GyroIntegral gyro;
    for (double t = 0.0; t < kSeconds; t += 0.002)
      gyro.add({timestamp_from_seconds(rate * t), swaying(t), {0, 0, 9.81}});
    const auto found = other_clock_rate(turns, gyro, Duration(0), rate);
    EXPECT_EQ(found.has_value(), rate != 1.0) << rate;
    if (found) {
      EXPECT_NEAR(found->rate / rate, 1.0, 0.005);
    }
  }
}

}  // namespace
}  // namespace edged

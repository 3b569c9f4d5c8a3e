// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/allan_deviation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace edged {
namespace {

constexpr double kRate_Hz = 200.0;

/// White noise of a density and a bias that walks.
SignalNoise measured(double white, double walk, double length_s, int seed, bool gaps = false) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::normal_distribution<double> normal;
  AllanDeviation deviation(1.0 / kRate_Hz);
  double bias = 0.01;
  for (int i = 0; i < static_cast<int>(length_s * kRate_Hz); ++i) {
    bias += walk / std::sqrt(kRate_Hz) * normal(random);
    deviation.add(bias + white * std::sqrt(kRate_Hz) * normal(random));
    if (gaps && i % 100'000 == 99'999) deviation.skip_gap(), bias += 1.0;
  }
  return fit_noise(deviation.points());
}

TEST(AllanDeviation, GivesDensityAndWalkOfAnHour) {
  for (const bool gaps : {false, true}) {
    for (int seed = 1; seed <= 3; ++seed) {
      const SignalNoise noise = measured(2e-3, 3e-4, 3600.0, seed, gaps);
      EXPECT_NEAR(noise.white, 2e-3, 4e-5);
      EXPECT_NEAR(noise.walk, 3e-4, 9e-5);
      EXPECT_GT(noise.walk, 3.0 * noise.walk_sigma);
    }
  }
}

TEST(AllanDeviation, OfAMinuteGivesTheDensityAndDoesNotMakeUpAWalk) {
  for (int seed = 1; seed <= 5; ++seed) {
    const SignalNoise noise = measured(2e-3, 0.0, 60.0, seed);
    EXPECT_NEAR(noise.white, 2e-3, 1e-4);
    EXPECT_LT(noise.walk, 3.0 * noise.walk_sigma + 1e-4);
  }
}

TEST(AllanDeviation, OfAnOffsetAloneHasNoPoints) {
  AllanDeviation deviation(0.005);
  for (int i = 0; i < 1000; ++i) deviation.add(0.25);
  EXPECT_TRUE(deviation.points().empty());
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/statistics.hpp"

#include <gtest/gtest.h>

#include <random>

namespace edged {
namespace {

TEST(Median, IsTheMiddleValueWhateverTheOrder) {
  EXPECT_EQ(median({3.0, -1.0, 7.0}), 3.0);
  EXPECT_EQ(median({5.0}), 5.0);
}

TEST(Median, OfAnEvenNumberIsTheUpperOfTheMiddleTwo) { EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 3.0); }

TEST(Median, OfNothingIsZero) { EXPECT_EQ(median({}), 0.0); }

TEST(RobustDeviation, IsTheStandardDeviationOfNormalValuesDespiteOutliers) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal(4.0, 0.5);
  std::vector<double> values(10000);
  for (double& v : values) v = normal(engine);
  EXPECT_NEAR(robust_deviation(values, 4.0), 0.5, 0.02);
  for (std::size_t i = 0; i < 1000; ++i) values[i] = 1e6;
  EXPECT_NEAR(robust_deviation(values, 4.0), 0.5, 0.08);
}

TEST(RobustDeviation, OfEqualValuesIsZero) { EXPECT_EQ(robust_deviation({2.0, 2.0, 2.0}, 2.0), 0.0); }

}  // namespace
}  // namespace edged

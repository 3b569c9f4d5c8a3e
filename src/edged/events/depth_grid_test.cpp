// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/depth_grid.hpp"

#include <gtest/gtest.h>

#include "edged/core/check.hpp"

namespace edged {
namespace {

TEST(DepthGrid, HoldsTheDepthOfTheNearestSample) {
  const std::vector<DepthSample> samples = {{{20, 20}, 2.0}, {{60, 20}, 4.0}};
  const DepthGrid grid(100, 50, {8, 30.0}, samples, 10.0);
  EXPECT_FLOAT_EQ(grid.inverse_depth(20, 20), 0.5F);
  EXPECT_FLOAT_EQ(grid.inverse_depth(30, 25), 0.5F);
  EXPECT_FLOAT_EQ(grid.inverse_depth(60, 10), 0.25F);
}

TEST(DepthGrid, FallsBackToTheScenesDepthBeyondTheReach) {
  const std::vector<DepthSample> samples = {{{20, 20}, 2.0}};
  const DepthGrid grid(100, 50, {8, 30.0}, samples, 10.0);
  EXPECT_FLOAT_EQ(grid.inverse_depth(90, 40), 0.1F);
  EXPECT_FLOAT_EQ(DepthGrid(100, 50, {}, {}, 5.0).inverse_depth(50, 25), 0.2F);
}

TEST(DepthGrid, AnswersOutsideTheImageWithTheNearestCell) {
  const std::vector<DepthSample> samples = {{{0, 0}, 2.0}};
  const DepthGrid grid(100, 50, {8, 30.0}, samples, 10.0);
  EXPECT_FLOAT_EQ(grid.inverse_depth(-500, -3), 0.5F);
  EXPECT_FLOAT_EQ(grid.inverse_depth(1000, 1000), 0.1F);
}

TEST(DepthGrid, IgnoresDepthsThatAreNotPositive) {
  const std::vector<DepthSample> samples = {{{20, 20}, 0.0}, {{24, 20}, -1.0}};
  EXPECT_FLOAT_EQ(DepthGrid(100, 50, {}, samples, 5.0).inverse_depth(20, 20), 0.2F);
  EXPECT_THROW(DepthGrid(100, 50, {}, samples, 0.0), CheckError);
}

}  // namespace
}  // namespace edged

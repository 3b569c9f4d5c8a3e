// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/lens_residual.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace edged {
namespace {

constexpr int kWidth = 240, kHeight = 180;

TEST(LensResidual, IsSmoothAndHasItsRms) {
  double sum = 0.0, steepest = 0.0;
  constexpr int kSeeds = 40;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const LensResidual residual(0.2, kWidth, static_cast<std::uint64_t>(seed));
    for (int y = 0; y < kHeight; y += 10) {
      for (int x = 0; x < kWidth; x += 10) {
        const Eigen::Vector2d here = residual.at({x, y});
        sum += here.squaredNorm();
        steepest = std::max(steepest, (residual.at({x + 1.0, y}) - here).norm());
      }
    }
  }
  EXPECT_NEAR(std::sqrt(sum / (kSeeds * 18 * 24)), 0.2, 0.02);
  EXPECT_LT(steepest, 0.03) << "pixels per pixel: rays stay in order";
}

TEST(LensResidual, IsNoneWithoutOneAndAnotherForAnotherLens) {
  EXPECT_TRUE(LensResidual().at({10.0, 20.0}).isZero());
  EXPECT_TRUE(LensResidual(0.0, kWidth, 1).at({10.0, 20.0}).isZero());
  const LensResidual one(0.2, kWidth, 1), same(0.2, kWidth, 1), other(0.2, kWidth, 2);
  EXPECT_EQ(one.at({10.0, 20.0}), same.at({10.0, 20.0}));
  EXPECT_NE(one.at({10.0, 20.0}), other.at({10.0, 20.0}));
}

}  // namespace
}  // namespace edged

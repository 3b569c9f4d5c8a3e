// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/height_factor.hpp"

#include <gtest/gtest.h>

#include "edged/estimator/factors/test_motion.hpp"

namespace edged {
namespace {

constexpr BlockKey kBias{BlockKind::HeightBias, 0};

TEST(HeightFactor, JacobiansMatchCentralDifferences) {
  const TestMotion motion;
  const HeightFactor factor(0, kBias, motion.between(0.1, 0.35), 2.5, 0.2);
  check_jacobians(factor, motion.shifted(0.1, 0.4));
}

TEST(HeightFactor, IsZeroForTheHeightThatWasThere) {
  const TestMotion motion;
  const double height = motion.at(0.35).T_O_B.translation().z() + 7.0;
  const HeightFactor factor(0, kBias, motion.between(0.1, 0.35), height, 0.2);
  const Blocks blocks = motion.blocks(0.1, 0.0);
  EXPECT_NEAR(factor.bias_at(blocks[0].data(), blocks[1].data()), 7.0, 1e-6);
  EXPECT_NEAR(evaluate(factor, motion.blocks(0.1, 7.0))[0], 0.0, 1e-5);
  EXPECT_NEAR(evaluate(factor, motion.blocks(0.1, 7.2))[0], 1.0, 1e-5);
}

TEST(HeightFactor, MovesWithItsStateToTheStateBefore) {
  const TestMotion motion;
  const double height = motion.at(0.4).T_O_B.translation().z();
  const HeightFactor factor(1, kBias, motion.between(0.25, 0.4), height, 0.2);
  const auto moved = moved_to_state_before(factor, motion);
  EXPECT_EQ(moved->blocks()[0], (BlockKey{BlockKind::Pose, 0}));
  EXPECT_EQ(moved->blocks()[1], (BlockKey{BlockKind::Motion, 0}));
  EXPECT_EQ(moved->blocks()[2], kBias);
  EXPECT_NEAR(evaluate(*moved, motion.blocks(0.1, 0.0))[0], 0.0, 1e-5);
  check_jacobians(*moved, motion.shifted(0.1, 0.4));
  const HeightFactor at_once(0, kBias, motion.between(0.1, 0.4), height, 0.2);
  const Blocks blocks = motion.shifted(0.1, 0.4);
  EXPECT_NEAR(evaluate(*moved, blocks)[0], evaluate(at_once, blocks)[0], 1e-3);
}

TEST(HeightFactor, OfManySamplesHasTheMeanOfTheirResidualsByWeight) {
  const TestMotion motion;
  const auto one = [&] { return HeightFactor(0, kBias, motion.between(0.1, 0.2), 2.5, 0.1); };
  const HeightFactor other(0, kBias, motion.between(0.1, 0.4), 3.5, 0.2);
  expect_merged_mean(one(), other, one(), motion.shifted(0.1, 0.4));
}

TEST(HeightFactor, GoesIntoThePriorWithItsStateNotWithItsBias) {
  const HeightFactor factor(3, kBias, TestMotion().between(0.1, 0.2), 2.5, 0.1);
  EXPECT_TRUE(factor.marginalized_with({{BlockKind::Pose, 3}, {BlockKind::Motion, 3}, kBias}));
  EXPECT_FALSE(factor.marginalized_with({{BlockKind::Pose, 2}, {BlockKind::Motion, 2}, kBias}));
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/velocity_factor.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "edged/estimator/factors/height_factor.hpp"
#include "edged/estimator/factors/test_motion.hpp"

namespace edged {
namespace {

constexpr BlockKey kScaleError{BlockKind::VelocityScale, 0};
const SE3 kSensor(so3::exp({0.2, -0.1, 1.2}), {0.3, -0.1, 0.2});

TEST(VelocityFactor, JacobiansMatchCentralDifferences) {
  const TestMotion motion;
  VelocitySample sample = motion.velocity(0.35, kSensor, 0.1);
  for (const double last : {0.3, std::numeric_limits<double>::infinity()}) {
    sample.sigma = {0.1, 0.2, last};
    const VelocityFactor factor(0, kScaleError, motion.between(0.1, 0.35), kSensor, sample);
    check_jacobians(factor, motion.shifted(0.1, 0.2));
  }
}

TEST(VelocityFactor, IsZeroForTheVelocityThatWasThere) {
  const TestMotion motion;
  const VelocityFactor factor(0, kScaleError, motion.between(0.1, 0.35), kSensor, motion.velocity(0.35, kSensor, 0.05));
  EXPECT_LT(evaluate(factor, motion.blocks(0.1, 0.0)).norm(), 1e-4);
}

TEST(VelocityFactor, IsZeroForASensorThatReadsTooMuchByItsScaleError) {
  const TestMotion motion;
  VelocitySample sample = motion.velocity(0.35, kSensor, 0.05);
  sample.v_S *= 1.1;
  const VelocityFactor factor(0, kScaleError, motion.between(0.1, 0.35), kSensor, sample);
  EXPECT_LT(evaluate(factor, motion.blocks(0.1, 0.1)).norm(), 1e-4);
}

TEST(VelocityFactor, SaysNothingOfAnAxisThatIsNotMeasured) {
  const TestMotion motion;
  VelocitySample sample = motion.velocity(0.35, kSensor, 0.05);
  sample.v_S.x() = std::numeric_limits<double>::quiet_NaN();
  sample.sigma.x() = std::numeric_limits<double>::infinity();
  VelocityFactor factor(0, kScaleError, motion.between(0.1, 0.35), kSensor, sample);
  EXPECT_EQ(evaluate(factor, motion.shifted(0.1, 0.2))[0], 0.0);
  ASSERT_TRUE(factor.merge(VelocityFactor(0, kScaleError, motion.between(0.1, 0.35), kSensor, sample)));
  EXPECT_EQ(evaluate(factor, motion.shifted(0.1, 0.2))[0], 0.0);
  EXPECT_GT(std::abs(evaluate(factor, motion.shifted(0.1, 0.2))[1]), 0.1);
}

TEST(VelocityFactor, MovesWithItsStateToTheStateBefore) {
  const TestMotion motion;
  const VelocitySample sample = motion.velocity(0.4, kSensor, 0.05);
  const VelocityFactor factor(1, kScaleError, motion.between(0.25, 0.4), kSensor, sample);
  const auto moved = moved_to_state_before(factor, motion);
  EXPECT_EQ(moved->blocks()[0], (BlockKey{BlockKind::Pose, 0}));
  EXPECT_LT(evaluate(*moved, motion.blocks(0.1, 0.0)).norm(), 1e-4);
  check_jacobians(*moved, motion.shifted(0.1, 0.2));
}

TEST(VelocityFactor, OfManySamplesHasTheMeanOfTheirResidualsByWeight) {
  const TestMotion motion;
  VelocitySample first = motion.velocity(0.2, kSensor, 0.1);
  first.v_S += Eigen::Vector3d(0.1, 0.0, -0.2);
  const auto one = [&] { return VelocityFactor(0, kScaleError, motion.between(0.1, 0.2), kSensor, first); };
  const VelocityFactor other(0, kScaleError, motion.between(0.1, 0.4), kSensor, motion.velocity(0.4, kSensor, 0.2));
  expect_merged_mean(one(), other, one(), motion.shifted(0.1, 0.2));
}

TEST(VelocityFactor, DoesNotMergeWithAnotherKind) {
  const TestMotion motion;
  HeightFactor height(0, {BlockKind::HeightBias, 0}, motion.between(0.1, 0.2), 2.5, 0.1);
  EXPECT_FALSE(height.merge(
      VelocityFactor(0, kScaleError, motion.between(0.1, 0.2), kSensor, motion.velocity(0.2, kSensor, 0.1))));
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Height and velocity: Jacobians, and samples whose state is dropped.
#include <gtest/gtest.h>

#include "edged/estimator/factors/height_factor.hpp"
#include "edged/estimator/factors/test_jacobians.hpp"
#include "edged/estimator/factors/velocity_factor.hpp"
#include "edged/imu/preintegration.hpp"

namespace edged {
namespace {

using Eigen::Vector3d;

constexpr BlockKey kBias{BlockKind::HeightBias, 0}, kScaleError{BlockKind::VelocityScale, 0};
constexpr double kImuStep_s = 0.005;

/// A body that turns and accelerates, from the truth of its IMU.
class Motion {
 public:
  Motion() {
    for (int i = 0; i <= 100; ++i) {
      const double t = kImuStep_s * i;
      samples_.push_back({timestamp_from_seconds(t), {0.8 + t, -0.5, 0.3 * t}, {0.4, 9.6 - t, 1.5 + 2 * t}});
    }
    OdomState start;
    start.t = samples_.front().t;
    start.T_O_B = SE3(so3::exp({0.3, -0.8, 0.2}), {1, 2, 3});
    start.v_O = {0.4, -0.3, 0.2};
    start.bias_gyro = {0.01, -0.02, 0.03};
    start.bias_accel = {0.1, 0.05, -0.1};
    for (const auto& sample : samples_) {
      states_.push_back(sample.t == start.t ? start : propagate(start, between(0.0, to_seconds(sample.t))));
    }
  }

  /// Around the true biases.
  Preintegration between(double from_s, double to_s) const {
    const auto piece = slice_imu(samples_, timestamp_from_seconds(from_s), timestamp_from_seconds(to_s));
    return {piece, {0.01, -0.02, 0.03}, {0.1, 0.05, -0.1}, ImuNoise{}};
  }
  const OdomState& at(double t) const { return states_[static_cast<std::size_t>(std::lround(t / kImuStep_s))]; }

  Blocks blocks(double t) const {
    const OdomState& state = at(t);
    const PoseBlock pose = to_block(state.T_O_B);
    std::vector<double> motion;
    for (const Vector3d& part : {state.v_O, state.bias_gyro, state.bias_accel}) {
      motion.insert(motion.end(), part.begin(), part.end());
    }
    return {{pose.begin(), pose.end()}, motion};
  }
  Blocks blocks_with(double t, double scalar) const {
    Blocks all = blocks(t);
    all.push_back({scalar});
    return all;
  }
  /// The measurement of a sensor at T_B_S.
  VelocitySample velocity(double t, const SE3& T_B_S, double sigma) const {
    const OdomState& state = at(t);
    const Vector3d omega = samples_[static_cast<std::size_t>(std::lround(t / kImuStep_s))].gyro_B - state.bias_gyro;
    const Vector3d v_B = state.T_O_B.R().transpose() * state.v_O + omega.cross(T_B_S.translation());
    return {state.t, T_B_S.R().transpose() * v_B, Vector3d::Constant(sigma)};
  }

 private:
  std::vector<ImuSample> samples_;
  std::vector<OdomState> states_;
};

const SE3 kSensor(so3::exp({0.2, -0.1, 1.2}), {0.3, -0.1, 0.2});

/// Away from where the residual is zero.
Blocks shifted(Blocks blocks) {
  blocks[0][2] += 0.3;
  for (double& number : blocks[1]) number += 0.02;
  return blocks;
}

TEST(HeightFactor, JacobiansMatchCentralDifferences) {
  const Motion motion;
  const HeightFactor factor(0, kBias, motion.between(0.1, 0.35), 2.5, 0.2);
  check_jacobians(factor, {BlockKind::Pose, BlockKind::Motion, BlockKind::HeightBias},
                  shifted(motion.blocks_with(0.1, 0.4)));
}

TEST(HeightFactor, IsZeroForTheHeightThatWasThere) {
  const Motion motion;
  const double height = motion.at(0.35).T_O_B.translation().z() + 7.0;
  const HeightFactor factor(0, kBias, motion.between(0.1, 0.35), height, 0.2);
  const Blocks blocks = motion.blocks(0.1);
  EXPECT_NEAR(factor.bias_at(blocks[0].data(), blocks[1].data()), 7.0, 1e-6);
  EXPECT_NEAR(evaluate(factor, motion.blocks_with(0.1, 7.0))[0], 0.0, 1e-5);
  EXPECT_NEAR(evaluate(factor, motion.blocks_with(0.1, 7.2))[0], 1.0, 1e-5);
}

TEST(HeightFactor, MovesWithItsStateToTheStateBefore) {
  const Motion motion;
  const double height = motion.at(0.4).T_O_B.translation().z();
  const HeightFactor factor(1, kBias, motion.between(0.25, 0.4), height, 0.2);
  const Preintegration into = motion.between(0.1, 0.25), joined = motion.between(0.1, 0.5);
  const auto moved = factor.without({0, 1, 2, joined, into});
  EXPECT_EQ(moved->blocks()[0], (BlockKey{BlockKind::Pose, 0}));
  EXPECT_EQ(moved->blocks()[1], (BlockKey{BlockKind::Motion, 0}));
  EXPECT_EQ(moved->blocks()[2], kBias);
  EXPECT_NEAR(evaluate(*moved, motion.blocks_with(0.1, 0.0))[0], 0.0, 1e-5);
  check_jacobians(*moved, {BlockKind::Pose, BlockKind::Motion, BlockKind::HeightBias},
                  shifted(motion.blocks_with(0.1, 0.4)));
  const HeightFactor at_once(0, kBias, motion.between(0.1, 0.4), height, 0.2);
  const Blocks blocks = shifted(motion.blocks_with(0.1, 0.4));
  EXPECT_NEAR(evaluate(*moved, blocks)[0], evaluate(at_once, blocks)[0], 1e-3);
}

TEST(HeightFactor, OfManySamplesHasTheMeanOfTheirResidualsByWeight) {
  const Motion motion;
  const HeightFactor one(0, kBias, motion.between(0.1, 0.2), 2.5, 0.1),
      other(0, kBias, motion.between(0.1, 0.4), 3.5, 0.2);
  HeightFactor both(0, kBias, motion.between(0.1, 0.2), 2.5, 0.1);
  ASSERT_TRUE(both.absorb(other));
  const Blocks blocks = shifted(motion.blocks_with(0.1, 0.4));
  const double r = evaluate(one, blocks)[0], r_other = evaluate(other, blocks)[0];
  EXPECT_NEAR(evaluate(both, blocks)[0], (r / 0.1 + r_other / 0.2) / std::sqrt(1.0 / 0.01 + 1.0 / 0.04), 1e-9);
  check_jacobians(both, {BlockKind::Pose, BlockKind::Motion, BlockKind::HeightBias}, blocks);
}

TEST(HeightFactor, GoesIntoThePriorWithItsStateNotWithItsBias) {
  const HeightFactor factor(3, kBias, Motion().between(0.1, 0.2), 2.5, 0.1);
  EXPECT_TRUE(factor.marginalized_with({{BlockKind::Pose, 3}, {BlockKind::Motion, 3}, kBias}));
  EXPECT_FALSE(factor.marginalized_with({{BlockKind::Pose, 2}, {BlockKind::Motion, 2}, kBias}));
}

TEST(VelocityFactor, JacobiansMatchCentralDifferences) {
  const Motion motion;
  VelocitySample sample = motion.velocity(0.35, kSensor, 0.1);
  for (const double last : {0.3, std::numeric_limits<double>::infinity()}) {
    sample.sigma = {0.1, 0.2, last};
    const VelocityFactor factor(0, kScaleError, motion.between(0.1, 0.35), kSensor, sample);
    check_jacobians(factor, {BlockKind::Pose, BlockKind::Motion, BlockKind::VelocityScale},
                    shifted(motion.blocks_with(0.1, 0.2)));
  }
}

TEST(VelocityFactor, IsZeroForTheVelocityThatWasThere) {
  const Motion motion;
  const VelocityFactor factor(0, kScaleError, motion.between(0.1, 0.35), kSensor, motion.velocity(0.35, kSensor, 0.05));
  EXPECT_LT(evaluate(factor, motion.blocks_with(0.1, 0.0)).norm(), 1e-4);
}

TEST(VelocityFactor, IsZeroForASensorThatReadsTooMuchByItsScaleError) {
  const Motion motion;
  VelocitySample sample = motion.velocity(0.35, kSensor, 0.05);
  sample.v_S *= 1.1;
  const VelocityFactor factor(0, kScaleError, motion.between(0.1, 0.35), kSensor, sample);
  EXPECT_LT(evaluate(factor, motion.blocks_with(0.1, 0.1)).norm(), 1e-4);
}

TEST(VelocityFactor, SaysNothingOfAnAxisThatIsNotMeasured) {
  const Motion motion;
  VelocitySample sample = motion.velocity(0.35, kSensor, 0.05);
  sample.v_S.x() = std::numeric_limits<double>::quiet_NaN();
  sample.sigma.x() = std::numeric_limits<double>::infinity();
  VelocityFactor factor(0, kScaleError, motion.between(0.1, 0.35), kSensor, sample);
  EXPECT_EQ(evaluate(factor, shifted(motion.blocks_with(0.1, 0.2)))[0], 0.0);
  ASSERT_TRUE(factor.absorb(VelocityFactor(0, kScaleError, motion.between(0.1, 0.35), kSensor, sample)));
  EXPECT_EQ(evaluate(factor, shifted(motion.blocks_with(0.1, 0.2)))[0], 0.0);
  EXPECT_GT(std::abs(evaluate(factor, shifted(motion.blocks_with(0.1, 0.2)))[1]), 0.1);
}

TEST(VelocityFactor, MovesWithItsStateToTheStateBefore) {
  const Motion motion;
  const VelocitySample sample = motion.velocity(0.4, kSensor, 0.05);
  const VelocityFactor factor(1, kScaleError, motion.between(0.25, 0.4), kSensor, sample);
  const Preintegration into = motion.between(0.1, 0.25), joined = motion.between(0.1, 0.5);
  const auto moved = factor.without({0, 1, 2, joined, into});
  EXPECT_EQ(moved->blocks()[0], (BlockKey{BlockKind::Pose, 0}));
  EXPECT_LT(evaluate(*moved, motion.blocks_with(0.1, 0.0)).norm(), 1e-4);
  check_jacobians(*moved, {BlockKind::Pose, BlockKind::Motion, BlockKind::VelocityScale},
                  shifted(motion.blocks_with(0.1, 0.2)));
}

TEST(VelocityFactor, OfManySamplesHasTheMeanOfTheirResidualsByWeight) {
  const Motion motion;
  VelocitySample first = motion.velocity(0.2, kSensor, 0.1), second = motion.velocity(0.4, kSensor, 0.2);
  first.v_S += Vector3d(0.1, 0.0, -0.2);
  const VelocityFactor one(0, kScaleError, motion.between(0.1, 0.2), kSensor, first),
      other(0, kScaleError, motion.between(0.1, 0.4), kSensor, second);
  VelocityFactor both(0, kScaleError, motion.between(0.1, 0.2), kSensor, first);
  ASSERT_TRUE(both.absorb(other));
  const Blocks blocks = shifted(motion.blocks_with(0.1, 0.2));
  const Eigen::VectorXd expected =
      (evaluate(one, blocks) / 0.1 + evaluate(other, blocks) / 0.2) / std::sqrt(1.0 / 0.01 + 1.0 / 0.04);
  EXPECT_LT((evaluate(both, blocks) - expected).norm(), 1e-9);
  check_jacobians(both, {BlockKind::Pose, BlockKind::Motion, BlockKind::VelocityScale}, blocks);
}

TEST(ExternalFactors, OfTwoKindsAreNotOne) {
  const Motion motion;
  HeightFactor height(0, kBias, motion.between(0.1, 0.2), 2.5, 0.1);
  EXPECT_FALSE(height.absorb(
      VelocityFactor(0, kScaleError, motion.between(0.1, 0.2), kSensor, motion.velocity(0.2, kSensor, 0.1))));
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/linear_prior.hpp"

#include <gtest/gtest.h>

#include <random>

#include "edged/estimator/factors/test_jacobians.hpp"
#include "edged/state.hpp"

namespace edged {
namespace {

TEST(RestPrior, IsWhatAnAccelerometerAtRestReadsToFirstOrder) {
  const Eigen::Vector3d accel_B(0.4, -0.3, 9.9);
  const SE3 upright(Eigen::Quaterniond::FromTwoVectors(accel_B, Eigen::Vector3d::UnitZ()), {1.0, 2.0, 3.0});
  const MotionBlock unbiased{};
  const LinearPrior prior =
      rest_prior({BlockKind::Pose, 0}, to_block(upright), {BlockKind::Motion, 0}, unbiased, accel_B, 0.5);
  const LinearPriorFactor factor(prior);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d small = 1e-4 * Eigen::Vector3d::Unit(axis);
    const SE3 tilted(upright.rotation() * so3::exp(small), upright.translation());
    MotionBlock biased = unbiased;
    biased[static_cast<std::size_t>(6 + (axis + 1) % 3)] = 0.05;
    const PoseBlock pose = to_block(tilted);
    const double* blocks[] = {pose.data(), biased.data()};
    Eigen::Vector3d r;
    ASSERT_TRUE(factor.Evaluate(blocks, r.data(), nullptr));
    const Eigen::Vector3d bias = Eigen::Map<const Eigen::Vector3d>(biased.data() + 6);
    EXPECT_LT((r - (tilted.R().transpose() * -kGravity_W + bias - accel_B) / 0.5).norm(), 1e-6);
  }
}

TEST(LinearPriorFactor, JacobiansMatchCentralDifferencesAwayFromItsLinearisationPoint) {
  std::mt19937_64 random(7);
  const auto number = [&] { return static_cast<double>(random() >> 11) * 0x1p-53 - 0.5; };
  LinearPrior prior;
  prior.blocks = {{BlockKind::Pose, 0}, {BlockKind::Motion, 0}};
  prior.x0 = {pose_block({0.1, 0.2, 0.3}, {1, 2, 3}), std::vector<double>(9, 0.1)};
  prior.J = Eigen::MatrixXd::NullaryExpr(12, 15, [&] { return number(); });
  prior.r = Eigen::VectorXd::NullaryExpr(12, [&] { return number(); });
  const LinearPriorFactor factor(prior);
  check_jacobians(factor, {pose_block({0.15, 0.1, 0.4}, {1.1, 2, 2.9}), std::vector<double>(9, 0.2)});
}

TEST(GaugePrior, SeesYawAndPositionButNotTilt) {
  const auto at = pose_block({0.4, -0.3, 0.8}, {1, 2, 3});
  PoseBlock block;
  std::copy(at.begin(), at.end(), block.begin());
  const LinearPrior prior = gauge_prior({BlockKind::Pose, 0}, block, 1e-2, 1e-2);
  const LinearPriorFactor factor(prior);
  const auto turned_about = [&](const Eigen::Vector3d& axis_O) {
    const PoseBlock b = to_block(SE3(so3::exp(1e-3 * axis_O) * pose_of(at.data()).rotation(), {1, 2, 3}));
    return evaluate(factor, {{b.begin(), b.end()}}).norm();
  };
  EXPECT_NEAR(turned_about(Eigen::Vector3d::UnitZ()), 0.1, 1e-6);
  EXPECT_NEAR(turned_about(Eigen::Vector3d::UnitX()), 0.0, 1e-4);
}

}  // namespace
}  // namespace edged

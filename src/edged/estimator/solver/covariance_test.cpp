// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/solver/covariance.hpp"

#include <gtest/gtest.h>

#include "edged/estimator/solver/marginalization.hpp"
#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

TEST(Covariance, IsTheInverseOfWhatMarginalisationLeavesOfAState) {
  TestWorld world({});
  Window window = inertial_window(world);
  const StateId newest = window.newest_id();
  const std::optional<Matrix15d> P = covariance(window, newest);
  ASSERT_TRUE(P);

  const Cost cost = cost_of(window);
  std::set<BlockKey> others = blocks_of(cost);
  others.erase({BlockKind::Pose, newest});
  others.erase({BlockKind::Motion, newest});
  const LinearPrior left = marginalize(window, cost, others);
  const Matrix15d product = left.J.transpose() * left.J * *P;
  EXPECT_LT((product - Matrix15d::Identity()).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(Covariance, IsNothingWhenADirectionIsNotDetermined) {
  TestWorld world({});
  const Window window = inertial_window(world, Gauge::Free);
  EXPECT_FALSE(covariance(window, window.newest_id()));
}

}  // namespace
}  // namespace edged

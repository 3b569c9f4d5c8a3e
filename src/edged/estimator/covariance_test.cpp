// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/covariance.hpp"

#include <gtest/gtest.h>

#include "edged/estimator/marginalization.hpp"
#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

TEST(Covariance, IsTheInverseOfWhatMarginalisationLeavesOfAState) {
  TestWorld world({});
  Window window = inertial_window(world);
  const StateId newest = window.states.rbegin()->first;
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
  Window window = inertial_window(world);
  std::erase_if(window.soft_priors, [](const LinearPrior& prior) { return prior.blocks[0].kind == BlockKind::Pose; });
  EXPECT_FALSE(covariance(window, window.states.rbegin()->first));
}

}  // namespace
}  // namespace edged

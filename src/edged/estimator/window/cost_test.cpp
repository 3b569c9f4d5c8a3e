// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The list of terms of a window.
#include "edged/estimator/window/cost.hpp"

#include <gtest/gtest.h>

#include "edged/estimator/factors/imu_factor.hpp"
#include "edged/estimator/factors/standstill_factor.hpp"
#include "edged/estimator/solver/normal_equations.hpp"
#include "edged/estimator/test_world.hpp"
#include "edged/estimator/window/landmarks.hpp"

namespace edged {
namespace {

/// A state 0.2 s after the newest, without an image.
StateId add_next(Window& window, bool rested = false) {
  WindowState next = window.newest();
  next.t += std::chrono::milliseconds(200);
  next.stationary = rested;
  return window.add_state(std::move(next));
}

TEST(Cost, HasHandSetPriorsBeforeMeasurements) {
  Tracked tracked({}, 2);
  Window& window = tracked.window;
  const StateId last = add_next(window, true);
  window.add_soft_prior(motion_prior({BlockKind::Motion, last}, window.newest().motion, {1.0, 1.0, 1.0}));
  const Cost cost = cost_of(window);
  EXPECT_EQ(cost.prior, nullptr) << "nothing has been marginalised";
  ASSERT_EQ(cost.factors.size(), 4U + 3U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NE(dynamic_cast<const LinearPriorFactor*>(cost.factors[i].get()), nullptr);
  EXPECT_NE(dynamic_cast<const ImuFactor*>(cost.factors[4].get()), nullptr);
  EXPECT_NE(dynamic_cast<const ImuFactor*>(cost.factors[5].get()), nullptr);
  EXPECT_NE(dynamic_cast<const StandstillFactor*>(cost.factors[6].get()), nullptr);
}

TEST(Cost, SharesTheFactorsOfTheWindow) {
  const Tracked tracked({}, 3);
  const Window& window = tracked.window;
  EXPECT_EQ(cost_of(window).factors.back(), window.factors().back());
}

TEST(Cost, IsOfTheBlocksOfItsTermsButForDepthsThatCanBeEliminated) {
  Tracked tracked({.cameras = 2, .shared_ids = true}, 4);
  Window& window = tracked.window;
  triangulate_features(window, {});
  const std::set<BlockKey> blocks = blocks_of(cost_of(window));
  for (const auto& [id, state] : window.states()) {
    EXPECT_TRUE(blocks.contains({BlockKind::Pose, id}));
    EXPECT_TRUE(blocks.contains({BlockKind::Motion, id}));
  }
  EXPECT_TRUE(blocks.contains({BlockKind::Calibration, 0}) && blocks.contains({BlockKind::Calibration, 1}));
  EXPECT_EQ(blocks.size(), 2 * window.states().size() + 3U);  // and those of the IMU
}

TEST(Cost, HoldsEveryObservationOfALandmarkThatTwoCamerasSeeOnce) {
  Tracked tracked({.cameras = 2, .shared_ids = true}, 4, {0.9, 0.6});
  Window& window = tracked.window;
  triangulate_features(window, {});
  int seen_by_both = 0;
  for (const LandmarkTerm& term : cost_of(window).landmarks) {
    const Feature& feature = window.features().at(term.id);
    seen_by_both += feature.last_seen.size() == 2;
    std::set<ObservationKey> seen = {term.anchor};
    for (const LandmarkResidual& residual : term.residuals) {
      EXPECT_TRUE(seen.insert(residual.seen).second);
      EXPECT_EQ(residual.point.at_zero, feature.observations.at(residual.seen).point);
    }
    EXPECT_EQ(seen.size(), feature.observations.size());
  }
  EXPECT_GT(seen_by_both, 20);
}

TEST(Cost, LeavesOutStatesThatAreNoKeyframesWhereTheyWillBeDropped) {
  Tracked tracked({}, 3);
  Window& window = tracked.window;
  WindowState next = window.newest();
  next.t += std::chrono::milliseconds(200);
  next.keyframe = false;
  const StateId passing = window.add_state(std::move(next), {tracked.world.observe(1.6)});
  triangulate_features(window, {});
  const auto counts = [&](Observations observations) {
    int count = 0;
    for (const LandmarkTerm& term : cost_of(window, observations).landmarks) {
      count += static_cast<int>(std::ranges::count_if(
          term.residuals, [&](const LandmarkResidual& residual) { return residual.seen.state == passing; }));
    }
    return count;
  };
  EXPECT_GT(counts(Observations::All), 20);
  EXPECT_EQ(counts(Observations::OfKeyframes), 0);
}

TEST(Cost, CountsWhatMarginalisationHasLeft) {
  TestWorld world({});
  Window window = inertial_window(world);
  const BlockKey last{BlockKind::Pose, window.newest_id()};
  LinearPrior prior = gauge_prior(last, window.newest().pose, 0.1, 0.1);
  prior.information = prior.J.transpose() * prior.J;
  window.drop_oldest(std::move(prior));
  const double before = value_of(window, cost_of(window));
  Cost without = cost_of(window);
  without.prior = nullptr;
  EXPECT_DOUBLE_EQ(value_of(window, without), before);
  displace(window, last.id, {0.0, 0.0, 0.0}, window.newest().T_O_B().R().transpose() * Eigen::Vector3d(0.2, 0.0, 0.0));
  EXPECT_NEAR(value_of(window, cost_of(window)) - value_of(window, without), 0.5 * 2.0 * 2.0, 1e-9);
}

}  // namespace
}  // namespace edged

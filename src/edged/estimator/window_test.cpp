// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The window's bookkeeping, and its solution from poses and landmarks that are off.
#include "edged/estimator/window.hpp"

#include <gtest/gtest.h>

#include "edged/core/check.hpp"
#include "edged/estimator/cost.hpp"
#include "edged/estimator/landmarks.hpp"
#include "edged/estimator/solver.hpp"
#include "edged/estimator/test_world.hpp"

namespace edged {
namespace {

std::size_t terms_of(const Window& window) {
  const Cost cost = cost_of(window);
  std::size_t terms = cost.factors.size();
  for (const LandmarkTerm& landmark : cost.landmarks) terms += landmark.residuals.size();
  return terms;
}

double worst_position_error(const Window& window, const TestWorld& world) {
  double worst = 0.0;
  for (const auto& [id, state] : window.states) {
    worst = std::max(worst, (state.T_W_B().translation() - world.T_W_B(to_seconds(state.t)).translation()).norm());
  }
  return worst;
}

TEST(Window, HoldsEachTermOfTheCostOnce) {
  const TestWorldOptions options{.cameras = 2};
  TestWorld world(options);
  Window window = tracked_window(world, options);
  EXPECT_EQ(terms_of(window), 3U + 1U + 5U);  // calibrations, gauge, IMU; tracks are no landmarks yet
  triangulate_features(window, {});
  std::size_t observations = 0;
  for (const auto& [id, feature] : window.features) {
    if (feature.anchor) observations += feature.seen.size() - 1;
  }
  EXPECT_GT(observations, 100U);
  EXPECT_EQ(terms_of(window), 3U + 1U + 5U + observations);
}

TEST(Window, TakesLessOfAnErrorOnAnEventFrameForDrift) {
  const TestWorldOptions options{};
  TestWorld world(options);
  Window window = tracked_window(world, options);
  triangulate_features(window, {});
  window.track_noise = {0.9, 0.6, 2.0};
  const auto landmark =
      std::ranges::find_if(window.features, [](const auto& f) { return f.second.anchor.has_value(); });
  ASSERT_NE(landmark, window.features.end());
  const double decay = std::exp(-kTrackedPeriod_s / 2.0);
  window.cameras[0].modality = Modality::Frames;
  EXPECT_NEAR(track_steps(window, landmark->second).front().correlation, 0.9 * decay, 1e-9);
  window.cameras[0].modality = Modality::Events;
  EXPECT_NEAR(track_steps(window, landmark->second).front().correlation, 0.6 * decay, 1e-9);
}

TEST(Window, KnowsATrackAliveThroughStatesWithoutAnImageOfItsCamera) {
  TestWorld world({.cameras = 2});
  Window window(world.rig(), 1.0);
  const auto add = [&](double t, std::size_t camera) {
    WindowState state;
    state.t = timestamp_from_seconds(t);
    window.add_observations(window.add_state(std::move(state)), {world.observe(t, camera)});
  };
  add(1.0, 0);
  const FeatureId id = window.features.begin()->first;
  add(1.05, 1);
  EXPECT_TRUE(window.alive(window.features.at(id)));
  add(3.0, 0);  // far along: some have left the view
  int ended = 0;
  for (const auto& [feature_id, feature] : window.features) ended += window.alive(feature) ? 0 : 1;
  EXPECT_GT(ended, 0);
}

TEST(Window, RefusesObservationsOfACameraItDoesNotHave) {
  TestWorld world({});
  Window window(world.rig(), 1.0);
  const StateId id = window.add_state({});
  EXPECT_THROW(window.add_observations(id, {{"left", {}}}), CheckError);
}

TEST(Window, StrainsTheImuOnlyWhenAStateIsMovedAgainstIt) {
  const TestWorldOptions options{.imu_noise = 0.0};
  TestWorld world(options);
  Window window = tracked_window(world, options);
  EXPECT_LT(imu_strain(window), 0.5);
  window.states.rbegin()->second.pose[0] += 0.05;
  EXPECT_GT(imu_strain(window), 2.0);
}

TEST(Window, HoldsStatesTogetherBetweenWhichTheBodyRested) {
  const TestWorldOptions options;
  TestWorld world(options);
  Window window = tracked_window(world, options);
  const std::size_t before = terms_of(window);
  window.states.rbegin()->second.rested = true;
  EXPECT_EQ(terms_of(window), before + 1);
}

TEST(Window, ForgetsSoftPriorsWhoseStateHasLeft) {
  const TestWorldOptions options;
  TestWorld world(options);
  Window window = tracked_window(world, options);
  window.drop_orphaned_priors();
  EXPECT_EQ(window.soft_priors.size(), 3U);  // calibrations of camera and IMU, gauge
  window.states.erase(window.states.begin());
  window.drop_orphaned_priors();
  ASSERT_EQ(window.soft_priors.size(), 2U);
  EXPECT_EQ(window.soft_priors.front().blocks.front().kind, BlockKind::Calibration);
  EXPECT_EQ(window.soft_priors.back().blocks.front().kind, BlockKind::ImuIntrinsics);
}

TEST(Window, LinearisesWhatThePriorHoldsWhereThePriorWasMade) {
  const TestWorldOptions options;
  TestWorld world(options);
  Window window = tracked_window(world, options);
  const BlockKey first{BlockKind::Pose, window.states.begin()->first},
      last{BlockKind::Pose, window.states.rbegin()->first};
  window.prior = window.soft_priors.back();
  const double made_at = window.block(first)[0];
  window.move(first, std::array{0.5, 0.0, 0.0, 0.0, 0.0, 0.0});
  EXPECT_EQ(window.linearisation_point(first)[0], made_at);
  EXPECT_EQ(window.linearisation_point(last), window.block(last));
  EXPECT_EQ(window.block({BlockKind::InverseDepth, 123456}), nullptr);
}

TEST(Solve, FindsThePosesAgainFromTwoCamerasAndTheImu) {
  for (const int cameras : {1, 2}) {
    SCOPED_TRACE(cameras);
    const TestWorldOptions options{.cameras = cameras, .pixel_noise = 0.0, .imu_noise = 0.0};
    TestWorld world(options);
    Window window = tracked_window(world, options);
    triangulate_features(window, {});
    int i = 0;
    for (auto& [id, state] : window.states) {
      if (++i == 1) continue;
      const SE3 off(so3::exp({0.02, -0.01 * i, 0.01}), Eigen::Vector3d(0.01 * i, -0.02, 0.015));
      state.pose = to_block(state.T_W_B() * off);
      state.motion[0] += 0.1;
    }
    for (auto& [id, feature] : window.features) feature.inverse_depth *= 1.1;
    ASSERT_GT(worst_position_error(window, world), 0.03);
    const SolveSummary summary = solve(window, 30);
    EXPECT_TRUE(summary.usable);
    EXPECT_LT(summary.final_cost, 1e-3 * summary.initial_cost);
    EXPECT_LT(worst_position_error(window, world), 1e-4);  // 3e-6
    for (const auto& [id, feature] : window.features) {
      if (!feature.anchor) continue;
      EXPECT_LT((window.position(feature) - world.point_W(id)).norm(), 5e-3) << id;
    }
  }
}

TEST(Solve, GivesTheSameBitsWhereverTheWindowLies) {
  const TestWorldOptions options{.cameras = 2};
  std::vector<double> results[2];
  std::vector<std::vector<char>> holes;
  for (std::vector<double>& result : results) {
    TestWorld world(options);
    Window window = tracked_window(world, options);
    triangulate_features(window, {});
    solve(window, 10);
    for (const auto& [id, state] : window.states) result.insert(result.end(), state.pose.begin(), state.pose.end());
    for (const auto& [id, feature] : window.features) result.push_back(feature.inverse_depth);
    for (std::size_t i = 1; i < 500; ++i) holes.emplace_back(i * 7 % 1900 + 1);
  }
  EXPECT_EQ(results[0], results[1]);
}

}  // namespace
}  // namespace edged

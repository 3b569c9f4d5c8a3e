// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The solution of the window from perturbed poses and landmarks.
#include <gtest/gtest.h>

#include "edged/estimator/solver/solver.hpp"
#include "edged/estimator/test_world.hpp"
#include "edged/estimator/window/landmarks.hpp"
#include "edged/estimator/window/window.hpp"

namespace edged {
namespace {

double worst_position_error(const Window& window, const TestWorld& world) {
  double worst = 0.0;
  for (const auto& [id, state] : window.states()) {
    worst = std::max(worst, (state.T_O_B().translation() - world.T_W_B(to_seconds(state.t)).translation()).norm());
  }
  return worst;
}

TEST(Solve, FindsThePosesAgainFromTwoCamerasAndTheImu) {
  for (const auto& [cameras, shared] : {std::pair(1, false), std::pair(2, false), std::pair(2, true)}) {
    SCOPED_TRACE(testing::Message() << cameras << (shared ? " see the same landmarks" : ""));
    Tracked tracked({.cameras = cameras, .shared_ids = shared, .pixel_noise = 0.0, .imu_noise = 0.0});
    Window& window = tracked.window;
    triangulate_features(window, {});
    int i = 0;
    for (const auto& [id, state] : window.states()) {
      if (++i == 1) continue;
      displace(window, id, {0.02, -0.01 * i, 0.01}, {0.01 * i, -0.02, 0.015});
      window.move({BlockKind::Motion, id}, std::array{0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0});
    }
    stretch_depths(window, 1.1);
    ASSERT_GT(worst_position_error(window, tracked.world), 0.03);
    const SolveSummary summary = solve(window, 30);
    EXPECT_TRUE(summary.usable);
    EXPECT_LT(summary.final_cost, 1e-3 * summary.initial_cost);
    EXPECT_LT(worst_position_error(window, tracked.world), 1e-4);  // 3e-6
    for (const auto& [id, feature] : window.features()) {
      if (!feature.anchor) continue;
      EXPECT_LT((window.position(feature) - tracked.world.point_W(id)).norm(), 5e-3) << id;
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
    for (const auto& [id, state] : window.states()) result.insert(result.end(), state.pose.begin(), state.pose.end());
    for (const auto& [id, feature] : window.features()) result.push_back(feature.inverse_depth);
    for (std::size_t i = 1; i < 500; ++i) holes.emplace_back(i * 7 % 1900 + 1);
  }
  EXPECT_EQ(results[0], results[1]);
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/flow_velocity.hpp"

#include <gtest/gtest.h>

#include "edged/estimator/test_world.hpp"
#include "edged/estimator/tuning.hpp"

namespace edged {
namespace {

constexpr double kInterval_s = 0.1, kDepth_m = 10.0;

/// Keyframes at the true poses.
Window short_window(TestWorld& world, int states) {
  Window window(world.rig());
  for (int i = 0; i < states; ++i) {
    const double t = 1.0 + kInterval_s * i;
    WindowState state;
    state.t = timestamp_from_seconds(t);
    state.pose = to_block(world.T_W_B(t));
    state.keyframe = true;
    window.add_state(std::move(state), {world.observe(t)});
  }
  return window;
}

TestWorldOptions far_scene(double speed, std::uint64_t seed) {
  return {.speed = speed, .near_m = 9.5, .far_m = 10.5, .seed = seed};
}

TEST(FlowVelocity, IsThatOfTheBodyWhateverTheLeverArm) {
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    TestWorld world(far_scene(0.5, seed));
    const auto flow = flow_velocity(short_window(world, 4), kDepth_m);
    ASSERT_TRUE(flow);
    const Eigen::Vector3d moved = world.T_W_B(1.0 + 3 * kInterval_s).translation() - world.T_W_B(1.0).translation();
    const Eigen::Vector3d truth = moved / (3 * kInterval_s);
    EXPECT_LT((flow->v_O - truth).norm(), 0.2 * truth.norm() + 0.03) << seed;
    EXPECT_GT(flow->sigma, 0.5 * kEstimatorTuning.flow_depth_sigma * truth.norm()) << "the depth may be wrong";
  }
}

TEST(FlowVelocity, IsZeroByItsSigmaInATurnInPlace) {
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    TestWorld world(far_scene(0.0, seed));
    const auto flow = flow_velocity(short_window(world, 6), kDepth_m);
    ASSERT_TRUE(flow);
    EXPECT_LT(flow->v_O.norm(), 3.0 * flow->sigma) << seed;
    EXPECT_LT(flow->sigma, 0.05) << "tracks of half a pixel, before 10 m";
  }
}

TEST(FlowVelocity, NeedsTracks) {
  TestWorld world(far_scene(0.0, 1));
  EXPECT_FALSE(flow_velocity(short_window(world, 1), kDepth_m));
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/world_frame.hpp"

#include <gtest/gtest.h>

#include "edged/se3.hpp"

namespace edged {
namespace {

NavState at(const SE3& T_W_B, const Eigen::Vector3d& v_W) {
  NavState state;
  state.T_W_B = T_W_B;
  state.v_W = v_W;
  return state;
}

TEST(WorldFrame, TheFirstStartMakesTheWorld) {
  WorldFrame world;
  world.restart(SE3(so3::exp({0.1, 0.2, 0.3}), {1, 2, 3}), at(SE3(), {0, 0, 0}));
  EXPECT_EQ(world.of(at(SE3(so3::exp({0, 0, 1}), {4, 5, 6}), {1, 0, 0})).T_W_B.translation(), Eigen::Vector3d(4, 5, 6));
}

TEST(WorldFrame, LaterStartsGoOnWithPositionAndYawButTheirOwnTilt) {
  WorldFrame world;
  world.restart(SE3(), at(SE3(), {0, 0, 0}));
  // Dead reckoning has come to `old`; the new start puts the body at its origin, with a tilt it knows better.
  const SE3 old(so3::exp({0, 0, 1.2}) * so3::exp({0.05, 0, 0}), {3, -1, 2});
  const NavState now = at(SE3(so3::exp({0.02, 0, 0}), {0.5, 0, 0}), {1, 0, 0});
  world.restart(now.T_W_B * old.inverse(), now);
  const NavState in_world = world.of(now);
  EXPECT_LT((in_world.T_W_B.translation() - old.translation()).norm(), 1e-9);
  const Eigen::Vector3d off = so3::log(so3::exp({0, 0, 1.2}).conjugate() * in_world.T_W_B.rotation());
  EXPECT_LT((off - Eigen::Vector3d(0.02, 0, 0)).norm(), 1e-3) << "the tilt of the new estimate, the yaw of the old";
  EXPECT_LT((in_world.v_W - so3::exp({0, 0, 1.2}) * now.v_W).norm(), 1e-3);
  const std::vector<Landmark> landmarks = world.of(std::vector<Landmark>{{7, now.T_W_B.translation()}});
  EXPECT_LT((landmarks.front().p_W - old.translation()).norm(), 1e-9) << "landmarks move along";
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/odom_to_map.hpp"

#include <gtest/gtest.h>

#include "edged/se3.hpp"

namespace edged {
namespace {

OdomState at(const SE3& T_O_B, const Eigen::Vector3d& v_O) {
  OdomState state;
  state.T_O_B = T_O_B;
  state.v_O = v_O;
  return state;
}

TEST(OdomToMap, TheFirstStartDefinesTheMapFrame) {
  OdomToMap odom_to_map;
  odom_to_map.restart(SE3(so3::exp({0.1, 0.2, 0.3}), {1, 2, 3}), at(SE3(), {0, 0, 0}));
  EXPECT_EQ(odom_to_map.in_map(at(SE3(so3::exp({0, 0, 1}), {4, 5, 6}), {1, 0, 0})).T_W_B.translation(),
            Eigen::Vector3d(4, 5, 6));
}

TEST(OdomToMap, LaterStartsGoOnWithPositionAndYawButTheirOwnTilt) {
  OdomToMap odom_to_map;
  odom_to_map.restart(SE3(), at(SE3(), {0, 0, 0}));
  // Dead reckoning has reached `old`; the new start has the body at its origin, with a more accurate tilt.
  const SE3 old(so3::exp({0, 0, 1.2}) * so3::exp({0.05, 0, 0}), {3, -1, 2});
  const OdomState now = at(SE3(so3::exp({0.02, 0, 0}), {0.5, 0, 0}), {1, 0, 0});
  odom_to_map.restart(now.T_O_B * old.inverse(), now);
  const NavState in_map = odom_to_map.in_map(now);
  EXPECT_LT((in_map.T_W_B.translation() - old.translation()).norm(), 1e-9);
  const Eigen::Vector3d off = so3::log(so3::exp({0, 0, 1.2}).conjugate() * in_map.T_W_B.rotation());
  EXPECT_LT((off - Eigen::Vector3d(0.02, 0, 0)).norm(), 1e-3) << "the tilt of the new estimate, the yaw of the old";
  EXPECT_LT((in_map.v_W - so3::exp({0, 0, 1.2}) * now.v_O).norm(), 1e-3);
  const std::vector<Landmark> landmarks = odom_to_map.in_map(std::vector<Landmark>{{7, now.T_O_B.translation()}});
  EXPECT_LT((landmarks.front().p_W - old.translation()).norm(), 1e-9) << "landmarks are transformed, too";
}

TEST(OdomToMap, KnowsWhereOWasAtEachTimeOfEachStart) {
  const auto x = [](double m) { return SE3(Eigen::Quaterniond::Identity(), {m, 0, 0}); };
  OdomToMap odom_to_map;
  odom_to_map.restart(Timestamp(std::chrono::seconds(1)));
  odom_to_map.correct(Timestamp(std::chrono::seconds(3)), x(1.0));
  odom_to_map.restart(Timestamp(std::chrono::seconds(5)));
  odom_to_map.correct(Timestamp(std::chrono::seconds(7)), x(2.0));
  const auto at = [&](std::size_t start, int s) {
    return odom_to_map.T_M_O(start, Timestamp(std::chrono::seconds(s))).translation().x();
  };
  EXPECT_EQ(at(0, 2), 0.0);
  EXPECT_EQ(at(0, 4), 1.0);
  EXPECT_EQ(at(1, 6), 1.0) << "a new start continues from the pose of the last one";
  EXPECT_EQ(at(1, 7), 2.0);
  odom_to_map.drop_dead_reckoning();
  EXPECT_EQ(at(1, 6), 2.0) << "dead reckoning was wrong since the start";
  odom_to_map.transform_earlier(x(10.0));
  EXPECT_EQ(at(0, 2), 10.0);
  EXPECT_EQ(at(1, 6), 2.0);
  EXPECT_EQ(odom_to_map.T_M_O().translation().x(), 2.0);
}

TEST(OdomToMap, ForgetsItsHistoryButNotWhereOIs) {
  OdomToMap odom_to_map;
  odom_to_map.restart(SE3(), {});
  odom_to_map.correct({}, SE3(Eigen::Quaterniond::Identity(), {3, 0, 0}));
  odom_to_map.clear_history();
  odom_to_map.restart(SE3(), {});
  EXPECT_EQ(odom_to_map.T_M_O(0, {}).translation().x(), 3.0);
}

}  // namespace
}  // namespace edged

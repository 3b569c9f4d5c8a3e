// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/odom_frame.hpp"

#include <gtest/gtest.h>

namespace edged::node {
namespace {

SE3 turned(double yaw, const Eigen::Vector3d& p) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())), p};
}

Step step_of(const SE3& T_M_O, const SE3& T_O_B) {
  Step step;
  step.status = TrackingStatus::Good;
  step.T_M_O = T_M_O;
  step.state.T_W_B = T_M_O * T_O_B;
  return step;
}

Step start_of(const SE3& T_M_O, const SE3& T_O_B) {
  Step step = step_of(T_M_O, T_O_B);
  step.started = "at rest";
  return step;
}

/// The body in odom.
Eigen::Vector3d in_odom(const OdomFrame& odom, const Step& step) {
  return odom.T_M_odom().inverse() * step.state.T_W_B.translation();
}

TEST(OdomFrame, IsNotMovedByWhatTheMapCorrects) {
  OdomFrame odom;
  odom.note(start_of(SE3(), SE3()));
  const Step corrected = step_of(turned(0.1, {0.5, 0.0, 0.0}), turned(0.0, {1.0, 0.0, 0.0}));
  EXPECT_NEAR(odom.note(corrected), (corrected.state.T_W_B.translation() - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_TRUE(in_odom(odom, corrected).isApprox(Eigen::Vector3d(1, 0, 0)));
}

TEST(OdomFrame, GoesOnWithANewStartWhereDeadReckoningHasBroughtTheBody) {
  OdomFrame odom;
  odom.note(start_of(SE3(), SE3()));
  const SE3 T_M_O = turned(0.0, {0.2, 0.0, 0.0});  // the map has corrected
  odom.note(step_of(T_M_O, turned(0.0, {2.0, 0.0, 0.0})));
  Step lost = step_of(T_M_O, turned(0.0, {2.0, 0.0, 0.0}));
  lost.status = TrackingStatus::Lost;
  EXPECT_EQ(odom.note(lost), 0.0);
  // By dead reckoning at 2.3 m of the old O: the new O begins in the body, turned.
  const SE3 T_O_new = turned(1.0, {2.3, 0.0, 0.0});
  const Step restarted = start_of(T_M_O * T_O_new, SE3());
  EXPECT_NEAR(odom.note(restarted), 0.0, 1e-12);
  EXPECT_TRUE(in_odom(odom, restarted).isApprox(Eigen::Vector3d(2.3, 0, 0)));
  const Step on = step_of(T_M_O * T_O_new, turned(0.0, {1.0, 0.0, 0.0}));
  odom.note(on);
  EXPECT_TRUE(in_odom(odom, on).isApprox(T_O_new * Eigen::Vector3d(1, 0, 0)));
}

TEST(OdomFrame, StaysWhereItWasWhenTheBodyIsRelocalizedWithTheStart) {
  OdomFrame odom;
  odom.note(start_of(SE3(), SE3()));
  odom.note(step_of(SE3(), turned(0.0, {2.0, 0.0, 0.0})));
  Step relocalized = start_of(turned(0.0, {7.0, 0.0, 0.0}), SE3());
  relocalized.relocalized = true;
  EXPECT_NEAR(odom.note(relocalized), 5.0, 1e-12);
  EXPECT_TRUE(in_odom(odom, relocalized).isApprox(Eigen::Vector3d(2, 0, 0)));
}

}  // namespace
}  // namespace edged::node

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/alignment.hpp"

#include <gtest/gtest.h>

#include "edged/core/check.hpp"
#include "edged/eval/test_trajectories.hpp"

namespace edged {
namespace {

std::vector<PosePair> pairs_of(const Trajectory& truth, const Trajectory& estimate) {
  return associate(truth, estimate).pairs;
}

TEST(Alignment, RecoversAKnownRigidTransform) {
  const Trajectory estimate = winding_motion();
  const Similarity found = align(pairs_of(moved(kTilted, estimate), estimate), AlignmentKind::SE3);
  EXPECT_LT((found.T.matrix() - kTilted.matrix()).norm(), 1e-12);
  EXPECT_EQ(found.scale, 1.0);
}

TEST(Alignment, RecoversAKnownScale) {
  const Trajectory estimate = winding_motion();
  const Trajectory truth = moved(kTilted, scaled(1.7, estimate));
  const Similarity found = align(pairs_of(truth, estimate), AlignmentKind::Sim3);
  EXPECT_NEAR(found.scale, 1.7, 1e-12);
  EXPECT_LT((found.T.matrix() - kTilted.matrix()).norm(), 1e-11);
}

TEST(Alignment, RecoversAKnownYawAndLeavesRollAndPitchAlone) {
  const SE3 turned(so3::exp({0, 0, 2.8}), Eigen::Vector3d(3, -5, 2));
  const Trajectory estimate = winding_motion();
  const Similarity exact = align(pairs_of(moved(turned, estimate), estimate), AlignmentKind::PositionYaw);
  EXPECT_LT((exact.T.matrix() - turned.matrix()).norm(), 1e-12);

  const Similarity tilted = align(pairs_of(moved(kTilted, estimate), estimate), AlignmentKind::PositionYaw);
  EXPECT_LT((tilted.T.R() * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(Alignment, NeverMirrors) {
  Trajectory estimate = winding_motion();
  Trajectory truth = estimate;
  for (StampedPose& pose : truth) pose.T.translation().z() *= -1.0;
  EXPECT_NEAR(align(pairs_of(truth, estimate), AlignmentKind::SE3).T.R().determinant(), 1.0, 1e-12);
}

TEST(Alignment, NoneIsTheIdentity) {
  EXPECT_EQ(align({}, AlignmentKind::None).T.matrix(), Eigen::Matrix4d::Identity());
}

TEST(Alignment, RefusesWhatDoesNotFixTheRotation) {
  Trajectory line = winding_motion();
  for (StampedPose& pose : line) pose.T.translation() = Eigen::Vector3d(0, 0, to_seconds(pose.t));
  EXPECT_THROW(align(pairs_of(line, line), AlignmentKind::SE3), InputError);
  EXPECT_THROW(align(pairs_of(line, line), AlignmentKind::PositionYaw), InputError);
  const Trajectory two = winding_motion(0.02);
  EXPECT_THROW(align(pairs_of(two, two), AlignmentKind::SE3), InputError);
}

TEST(TimeWindow, CountsFromTheFirstPairAndHoldsBothEnds) {
  const Trajectory trajectory = winding_motion(10.0, 10.0);
  const auto pairs = pairs_of(trajectory, trajectory);
  const auto inside = within(pairs, {3.0, 8.0});
  ASSERT_EQ(inside.size(), 51u);
  EXPECT_EQ(inside.front().t, timestamp_from_seconds(103.0));
  EXPECT_EQ(inside.back().t, timestamp_from_seconds(108.0));
  EXPECT_EQ(within(pairs, {}).size(), pairs.size());
  EXPECT_TRUE(within({}, {}).empty());
}

}  // namespace
}  // namespace edged

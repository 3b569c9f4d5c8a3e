// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/eval/association.hpp"

#include <gtest/gtest.h>

#include "edged/core/check.hpp"
#include "edged/eval/test_trajectories.hpp"

namespace edged {
namespace {

StampedPose pose(double t_s, double x, double yaw = 0.0) {
  return {timestamp_from_seconds(t_s), SE3(so3::exp({0, 0, yaw}), Eigen::Vector3d(x, 0, 0))};
}

TEST(Association, InterpolatesTheTruthAtTheStampOfTheEstimate) {
  const Trajectory truth = {pose(1.0, 0.0, 0.0), pose(1.1, 2.0, 0.4)};
  const Association result = associate(truth, {pose(1.025, 7.0)});
  ASSERT_EQ(result.pairs.size(), 1u);
  EXPECT_NEAR(result.pairs[0].truth.translation().x(), 0.5, 1e-12);
  EXPECT_NEAR(so3::log(result.pairs[0].truth.rotation()).z(), 0.1, 1e-12);
  EXPECT_EQ(result.pairs[0].estimate.translation().x(), 7.0);
}

TEST(Association, TakesBothEndsAndLeavesOutWhatLiesBeyond) {
  const Trajectory truth = {pose(1.0, 1.0), pose(1.1, 2.0)};
  const Association result = associate(truth, {pose(0.9, 0), pose(1.0, 0), pose(1.1, 0), pose(1.2, 0)});
  ASSERT_EQ(result.pairs.size(), 2u);
  EXPECT_EQ(result.pairs[0].truth.translation().x(), 1.0);
  EXPECT_EQ(result.pairs[1].truth.translation().x(), 2.0);
  EXPECT_EQ(result.outside, 2u);
}

TEST(Association, DoesNotBridgeAGapInTheTruth) {
  const Trajectory truth = {pose(1.0, 0), pose(1.1, 0), pose(2.0, 0)};
  const Trajectory estimate = {pose(1.05, 0), pose(1.5, 0), pose(2.0, 0)};
  const Association result = associate(truth, estimate);
  EXPECT_EQ(result.pairs.size(), 2u);
  EXPECT_EQ(result.in_gaps, 1u);
  EXPECT_EQ(associate(truth, estimate, duration_from_seconds(1.0)).pairs.size(), 3u);
}

TEST(Association, TakesTheNearestPoseWithinTenMilliseconds) {
  const Trajectory truth = {pose(1.0, 0.0), pose(1.1, 2.0), pose(1.2, 4.0)};
  const Trajectory estimate = {pose(1.008, 7.0), pose(1.05, 7.0), pose(1.095, 7.0), pose(1.2, 7.0)};
  const Association result = associate(truth, estimate, duration_from_seconds(1.0), Matching::Nearest);
  ASSERT_EQ(result.pairs.size(), 3u);
  EXPECT_EQ(result.pairs[0].truth.translation().x(), 0.0);
  EXPECT_EQ(result.pairs[1].truth.translation().x(), 2.0);
  EXPECT_EQ(result.pairs[2].truth.translation().x(), 4.0);
  const Association sparse = associate(truth, {pose(1.05, 7.0), pose(1.195, 7.0)}, {}, Matching::Nearest);
  EXPECT_EQ(sparse.pairs.size(), 1u);
  EXPECT_EQ(sparse.in_gaps, 1u);
}

TEST(Association, InterpolatesTheEstimateWhereTheTruthIsSparser) {
  const Trajectory motion = winding_motion(20.0, 100.0);
  for (const std::size_t stride : {100U, 50U, 20U, 3U}) {  // 1, 2, 5, 33 Hz
    Trajectory truth, estimate;
    for (std::size_t i = 0; i < motion.size(); i += stride) truth.push_back(motion[i]);
    for (std::size_t i = 1; i < motion.size(); i += 2) estimate.push_back(motion[i]);  // 50 Hz, between these
    const Association result = associate(truth, estimate);
    EXPECT_GE(result.pairs.size() + 2, truth.size()) << stride;
    for (const PosePair& pair : result.pairs)
      EXPECT_LT((pair.truth.translation() - pair.estimate.translation()).norm(), 2e-4) << stride;
  }
}

TEST(Association, DoesNotBridgeAGapInTheEstimate) {
  const Trajectory truth = {pose(1.0, 0), pose(2.0, 0), pose(3.0, 0), pose(4.0, 0)};
  Trajectory estimate;
  for (int i = 0; i <= 300; ++i)
    if (i < 50 || i > 150) estimate.push_back(pose(1.0 + 0.01 * i, 0));
  const Association result = associate(truth, estimate);
  EXPECT_EQ(result.pairs.size(), 3u);
  EXPECT_EQ(result.in_gaps, 1u);
}

TEST(Association, SurvivesRepeatedStampsAndEmptyTrajectories) {
  const Trajectory truth = {pose(1.0, 0), pose(1.0, 1), pose(1.1, 2)};
  EXPECT_EQ(associate(truth, {pose(1.0, 0), pose(1.05, 0)}).pairs.size(), 2u);
  EXPECT_EQ(associate({}, {pose(1.0, 0)}).outside, 1u);
  EXPECT_TRUE(associate(truth, {}).pairs.empty());
}

TEST(Association, RefusesATrajectoryOutOfOrder) {
  EXPECT_THROW(associate({pose(2.0, 0), pose(1.0, 0)}, {}), InputError);
  EXPECT_THROW(associate({}, {pose(2.0, 0), pose(1.0, 0)}), InputError);
}

TEST(Association, ByIndexWantsEqualLengths) {
  EXPECT_EQ(associate_by_index({pose(1, 0)}, {pose(9, 3)}).pairs.size(), 1u);
  EXPECT_THROW(associate_by_index({pose(1, 0)}, {}), InputError);
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Voxels by the landmarks of a keyframe. The rest is tested where whole maps are made (apps/run/occupancy_test).
#include "edged/occupancy/occupancy_scan.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "edged/occupancy/test_keyframe.hpp"

namespace edged {
namespace {

const octomap::OcTreeNode* voxel_at(const octomap::OcTree& tree, double x) { return tree.search(x, 0.025, 0.025); }

TEST(OccupancyOfAKeyframe, IsOccupiedAtALandmarkAndFreeBeforeIt) {
  octomap::OcTree tree(0.05);
  insert_keyframe(tree, keyframe_before(2.025, 0.01));
  ASSERT_NE(voxel_at(tree, 2.025), nullptr);
  EXPECT_TRUE(tree.isNodeOccupied(voxel_at(tree, 2.025)));
  ASSERT_NE(voxel_at(tree, 1.0), nullptr);
  EXPECT_FALSE(tree.isNodeOccupied(voxel_at(tree, 1.0)));
  EXPECT_EQ(voxel_at(tree, 1.96), nullptr) << "within three sigmas";
  EXPECT_EQ(voxel_at(tree, 2.1), nullptr) << "behind";
}

TEST(OccupancyOfAKeyframe, IsOnlyFreeBeforeALandmarkOfUncertainDepth) {
  octomap::OcTree tree(0.05);
  insert_keyframe(tree, keyframe_before(2.025, 0.1));
  EXPECT_EQ(voxel_at(tree, 2.025), nullptr);
  EXPECT_NE(voxel_at(tree, 1.0), nullptr);
  EXPECT_EQ(voxel_at(tree, 1.8), nullptr);
}

TEST(OccupancyOfAKeyframe, LeavesOutWhatHasNoDepth) {
  octomap::OcTree tree(0.05);
  KeyframeRecord keyframe = keyframe_before(2.025, 0.01);
  for (const double inverse_depth : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    keyframe.views[0].points[0].inverse_depth = inverse_depth;
    insert_keyframe(tree, keyframe);
  }
  keyframe = keyframe_before(2.025, std::numeric_limits<double>::infinity());
  insert_keyframe(tree, keyframe);
  EXPECT_EQ(tree.size(), 0U);
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/occupancy/occupancy_slice.hpp"

#include <gtest/gtest.h>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// Occupied at x, y = 0.1 and z = 0.1, free above it and to the right of it.
octomap::OcTree three_voxels() {
  octomap::OcTree tree(0.2);
  tree.updateNode(0.1, 0.1, 0.1, true);
  tree.updateNode(0.1, 0.1, 0.3, false);
  tree.updateNode(0.5, 0.3, 0.1, false);
  return tree;
}

TEST(OccupancySliceOfATree, HasRowsFromTheLowestYOnAndOccupiedBeatsFree) {
  const auto slice = slice_of(three_voxels(), {0.0, 1.0}, 1e6);
  ASSERT_TRUE(slice);
  ASSERT_EQ(slice->cells.size(), cv::Size(3, 2));
  const auto cell = [&](int column, int row) { return static_cast<int>(slice->cells.at<schar>(row, column)); };
  EXPECT_EQ(cell(0, 0), OccupancySlice::kOccupied);
  EXPECT_EQ(cell(1, 0), OccupancySlice::kUnknown);
  EXPECT_EQ(cell(2, 1), OccupancySlice::kFree);
  EXPECT_NEAR(slice->corner_W.x(), 0.0, 1e-9);
  EXPECT_NEAR(slice->corner_W.y(), 0.0, 1e-9);
}

TEST(OccupancySliceOfATree, IsOfTheVoxelsBetweenTheHeights) {
  const auto slice = slice_of(three_voxels(), {0.25, 0.4}, 1e6);
  ASSERT_TRUE(slice);
  ASSERT_EQ(slice->cells.size(), cv::Size(1, 1));
  EXPECT_EQ(slice->cells.at<schar>(0, 0), OccupancySlice::kFree);
  EXPECT_FALSE(slice_of(three_voxels(), {2.0, 3.0}, 1e6)) << "nothing is known there";
}

TEST(OccupancySliceOfATree, ThatWouldBeTooLargeIsRefused) {
  EXPECT_THROW(slice_of(three_voxels(), {0.0, 1.0}, 5.0), InputError);
}

}  // namespace
}  // namespace edged

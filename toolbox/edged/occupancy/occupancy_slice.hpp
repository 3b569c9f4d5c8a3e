// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What an occupancy map has between two heights, and its occupied voxels.
#pragma once

#include <octomap/OcTree.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace edged {

/// Heights [m] in the map, the second above the first.
struct HeightRange {
  double low_m, high_m;
};

/// A grid seen from above, with cells as large as a voxel, as nav_msgs/OccupancyGrid of ROS has it.
struct OccupancySlice {
  static constexpr int kOccupied = 100, kFree = 0, kUnknown = -1;
  cv::Mat cells;             ///< CV_8SC1; columns along x, rows along y, from the lowest on
  Eigen::Vector2d corner_W;  ///< corner of the first cell, with the least x and y [m]
};

/// A cell is occupied if a voxel there is, else free if one is. Nothing where nothing is known between the heights.
/// Throws InputError if it had more than so many cells.
std::optional<OccupancySlice> slice_of(const octomap::OcTree& tree, const HeightRange& heights, double most_cells);

/// The centres of the occupied voxels [m]; larger leaves are many.
std::vector<Eigen::Vector3f> occupied_voxels(const octomap::OcTree& tree);

}  // namespace edged

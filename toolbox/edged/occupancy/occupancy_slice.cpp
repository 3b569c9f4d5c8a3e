// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/occupancy/occupancy_slice.hpp"

#include <algorithm>
#include <opencv2/core.hpp>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// A leaf as a square of voxels, seen from above.
struct Square {
  int x, y, size;
  bool occupied;
};

/// Number of voxels along the edge of a leaf.
template <typename Leaf>
int voxels_along(const octomap::OcTree& tree, const Leaf& leaf) {
  return 1 << (tree.getTreeDepth() - leaf.getDepth());
}

/// Cells that reach into the heights, the free ones first.
std::vector<Square> squares_between(const octomap::OcTree& tree, const HeightRange& heights) {
  std::vector<Square> squares;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const double half = 0.5 * leaf.getSize();
    if (leaf.getZ() + half <= heights.low_m || leaf.getZ() - half >= heights.high_m) continue;
    const octomap::OcTreeKey first = leaf.getIndexKey();
    squares.push_back({first[0], first[1], voxels_along(tree, leaf), tree.isNodeOccupied(*leaf)});
  }
  std::stable_partition(squares.begin(), squares.end(), [](const Square& square) { return !square.occupied; });
  return squares;
}

}  // namespace

std::optional<OccupancySlice> slice_of(const octomap::OcTree& tree, const HeightRange& heights, double most_cells) {
  const std::vector<Square> squares = squares_between(tree, heights);
  if (squares.empty()) return std::nullopt;
  cv::Point low(squares.front().x, squares.front().y), high = low;
  for (const auto& [x, y, size, occupied] : squares) {
    low = {std::min(low.x, x), std::min(low.y, y)};
    high = {std::max(high.x, x + size), std::max(high.y, y + size)};
  }
  const cv::Size size(high - low);
  if (1.0 * size.width * size.height > most_cells)
    throw InputError::format("a slice of the occupancy map would have {} x {} cells of {:g} m; choose larger voxels",
                             size.width, size.height, tree.getResolution());
  const auto corner_m = [&](int key) {
    return tree.keyToCoord(static_cast<octomap::key_type>(key)) - 0.5 * tree.getResolution();
  };
  OccupancySlice slice{cv::Mat(size, CV_8SC1, cv::Scalar(OccupancySlice::kUnknown)),
                       {corner_m(low.x), corner_m(low.y)}};
  for (const Square& square : squares) {
    const cv::Rect place(square.x - low.x, square.y - low.y, square.size, square.size);
    slice.cells(place).setTo(square.occupied ? OccupancySlice::kOccupied : OccupancySlice::kFree);
  }
  return slice;
}

std::vector<Eigen::Vector3f> occupied_voxels(const octomap::OcTree& tree) {
  std::vector<Eigen::Vector3f> centres;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (!tree.isNodeOccupied(*leaf)) continue;
    const int edge = voxels_along(tree, leaf);
    const octomap::OcTreeKey first = leaf.getIndexKey();
    for (int i = 0; i < edge * edge * edge; ++i) {
      const auto at = [&](unsigned axis, int steps) {
        return static_cast<float>(tree.keyToCoord(static_cast<octomap::key_type>(first[axis] + steps)));
      };
      centres.emplace_back(at(0, i % edge), at(1, i / edge % edge), at(2, i / edge / edge));
    }
  }
  return centres;
}

}  // namespace edged

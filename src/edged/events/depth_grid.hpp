// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// d_i of paper Eq. 2: a coarse depth image from a few points of known depth, looked up for every event.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <vector>

#include "edged/events/tuning.hpp"

namespace edged {

struct DepthGridSettings {
  int cell_px = kEventsTuning.cell_px;
  double reach_px = kEventsTuning.depth_reach_px;
};

struct DepthSample {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< undistorted
  double depth = 1.0;                               ///< z-depth [m]
};

/// One inverse depth per square cell of an image: that of the sample nearest to the cell's centre.
class DepthGrid {
 public:
  /// Samples whose depth is not positive are ignored. CheckError when scene_depth is not positive, or the size or the
  /// cell is empty.
  DepthGrid(int width, int height, const DepthGridSettings& settings, std::span<const DepthSample> samples,
            double scene_depth);

  /// [1/m]; outside the image that of the nearest cell.
  float inverse_depth(float x, float y) const {
    const int column = std::clamp(static_cast<int>(x * per_px_), 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(y * per_px_), 0, rows_ - 1);
    return cells_[static_cast<std::size_t>(row * columns_ + column)];
  }

 private:
  int columns_, rows_;
  float per_px_;  ///< 1 / cell side
  std::vector<float> cells_;
};

}  // namespace edged

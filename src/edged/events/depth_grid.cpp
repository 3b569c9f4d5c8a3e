// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/depth_grid.hpp"

#include "edged/core/check.hpp"

namespace edged {

DepthGrid::DepthGrid(int width, int height, const DepthGridSettings& settings, std::span<const DepthSample> samples,
                     double scene_depth)
    : columns_((width + settings.cell_px - 1) / settings.cell_px),
      rows_((height + settings.cell_px - 1) / settings.cell_px),
      per_px_(1.0F / static_cast<float>(settings.cell_px)) {
  EDGED_CHECK(width > 0 && height > 0 && settings.cell_px > 0, "{} x {} in cells of {}", width, height,
              settings.cell_px);
  EDGED_CHECK(scene_depth > 0.0, "scene depth is {}", scene_depth);
  cells_.reserve(static_cast<std::size_t>(columns_ * rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const Eigen::Vector2d centre = settings.cell_px * Eigen::Vector2d(column + 0.5, row + 0.5);
      double nearest = settings.reach_px * settings.reach_px, depth = scene_depth;
      for (const DepthSample& sample : samples) {
        const double distance = (sample.pixel - centre).squaredNorm();
        if (sample.depth > 0.0 && distance < nearest) nearest = distance, depth = sample.depth;
      }
      cells_.push_back(static_cast<float>(1.0 / depth));
    }
  }
}

}  // namespace edged

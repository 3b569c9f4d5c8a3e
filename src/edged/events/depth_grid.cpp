// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/depth_grid.hpp"

#include <algorithm>

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
  cells_.assign(static_cast<std::size_t>(columns_ * rows_), static_cast<float>(1.0 / scene_depth));
  std::vector<double> nearest(cells_.size(), settings.reach_px * settings.reach_px);
  const auto cell_of = [&](double px, int cells) {
    return static_cast<int>(std::clamp(px / settings.cell_px, 0.0, static_cast<double>(cells - 1)));
  };
  for (const DepthSample& sample : samples) {
    if (!(sample.depth > 0.0) || !sample.pixel.allFinite()) continue;
    const Eigen::Vector2d &at = sample.pixel, reach = Eigen::Vector2d::Constant(settings.reach_px);
    const Eigen::Vector2d low = at - reach, high = at + reach;
    for (int row = cell_of(low.y(), rows_); row <= cell_of(high.y(), rows_); ++row) {
      for (int column = cell_of(low.x(), columns_); column <= cell_of(high.x(), columns_); ++column) {
        const Eigen::Vector2d centre = settings.cell_px * Eigen::Vector2d(column + 0.5, row + 0.5);
        const auto cell = static_cast<std::size_t>(row * columns_ + column);
        const double distance = (at - centre).squaredNorm();
        if (distance < nearest[cell]) nearest[cell] = distance, cells_[cell] = static_cast<float>(1.0 / sample.depth);
      }
    }
  }
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/depth/landmark_depth.hpp"

#include <cmath>
#include <vector>

#include "edged/core/statistics.hpp"
#include "edged/depth/tuning.hpp"
#include "edged/events/voxel_grid.hpp"

namespace edged {

CentralRegion::CentralRegion(const CameraModel& camera, double share) {
  const cv::Rect region = central_region(cv::Size(camera.width(), camera.height()), share);
  low = camera.pixel_to_point(Eigen::Vector2d(region.x - 0.5, region.y - 0.5));
  high = camera.pixel_to_point(Eigen::Vector2d(region.x + region.width - 0.5, region.y + region.height - 0.5));
}

void LandmarkDepth::add_landmarks(Timestamp t, std::span<const SeenDepth> landmarks) {
  std::vector<double> logs;
  for (const SeenDepth& seen : landmarks) {
    if (region_.contains(seen.point) && seen.depth_m > 0.0) logs.push_back(std::log(seen.depth_m));
  }
  if (static_cast<int>(logs.size()) < kSceneDepthTuning.min_landmarks) return;
  const double middle = median(logs), spread = robust_deviation(logs, middle);
  // The standard error of the median of n values is 1.25 spread / sqrt(n); a twentieth is added for common errors.
  const double sigma = std::hypot(0.05, 1.25 * spread / std::sqrt(static_cast<double>(logs.size())));
  filter_.add({t, std::exp(middle), sigma, spread});
}

}  // namespace edged

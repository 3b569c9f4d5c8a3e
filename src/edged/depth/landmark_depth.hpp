// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The scene depth as the median of the landmarks in the central region.
#pragma once

#include <Eigen/Core>

#include "edged/camera/camera_model.hpp"
#include "edged/depth/depth_filter.hpp"

namespace edged {

struct LandmarkDepthConfig {
  int min_landmarks = 5;  ///< in the region, for a measurement

  void visit(ConfigFields& fields);
};

class LandmarkDepth : public DepthPrior {
 public:
  /// region_share: of each side of the image, around its middle.
  LandmarkDepth(const CameraModel& camera, double region_share, const LandmarkDepthConfig& config,
                const DepthFilterConfig& filter);

  void add_landmarks(Timestamp t, std::span<const SeenDepth> landmarks) override;
  std::optional<DepthEstimate> at(Timestamp t) const override { return filter_.at(t); }

 private:
  LandmarkDepthConfig config_;
  Eigen::Vector2d low_, high_;  // corners of the region on the unit plane
  DepthFilter filter_;
};

}  // namespace edged

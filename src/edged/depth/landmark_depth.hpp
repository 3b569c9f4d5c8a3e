// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The scene depth as the median of the landmarks in the central region.
#pragma once

#include <Eigen/Core>

#include "edged/depth/depth_filter.hpp"
#include "edged/rig.hpp"

namespace edged {

/// The central region of an image on the unit plane of its camera, between two corners.
struct CentralRegion {
  CentralRegion(const CameraModel& camera, double share);  ///< share: of each side of the image
  bool contains(const Eigen::Vector2d& point) const {
    return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
  }

  Eigen::Vector2d low, high;
};

class LandmarkDepth : public DepthPrior {
 public:
  /// region_share: of each side of the image, around its middle.
  LandmarkDepth(const CameraModel& camera, double region_share, const DepthFilterConfig& filter)
      : region_(camera, region_share), filter_(filter) {}

  void add_landmarks(Timestamp t, std::span<const SeenDepth> landmarks) override;
  std::optional<DepthEstimate> at(Timestamp t) const override { return filter_.at(t); }

 private:
  CentralRegion region_;
  DepthFilter filter_;
};

}  // namespace edged

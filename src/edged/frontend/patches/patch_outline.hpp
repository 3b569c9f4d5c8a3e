// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How a patch of one image appears in another: the affine warp by camera motion and depth.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "edged/frontend/patches/patch.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"

namespace edged {

/// A feature with two neighbouring points, on the unit plane of the camera that has seen it.
class PatchOutline {
 public:
  PatchOutline(const CameraModel& camera, const Eigen::Vector2d& feature_px)
      : PatchOutline(camera, feature_px, camera.pixel_to_point(feature_px)) {}
  /// feature: the same on the unit plane.
  PatchOutline(const CameraModel& camera, const Eigen::Vector2d& feature_px, const Eigen::Vector2d& feature);

  /// Where another camera, or the same one later, sees the patch. depth: z-depth of the feature and its neighbourhood
  /// in the camera of the patch [m]. Nothing outside the view of `to`, or where the scales differ too much.
  std::optional<PatchPlace> seen_by(const CameraModel& to, const SE3& T_to_from, double depth) const;

  const Eigen::Vector2d& feature() const { return feature_; }

 private:
  Eigen::Vector2d feature_, right_, below_;
};

}  // namespace edged

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

/// A corner with two neighbouring points, on the unit plane of the camera that has seen it.
class PatchOutline {
 public:
  PatchOutline(const CameraModel& camera, const Eigen::Vector2d& corner_px)
      : PatchOutline(camera, corner_px, camera.pixel_to_point(corner_px)) {}
  /// corner: the same on the unit plane.
  PatchOutline(const CameraModel& camera, const Eigen::Vector2d& corner_px, const Eigen::Vector2d& corner);

  /// Where another camera, or the same one later, sees the patch. depth: z-depth of the corner and its neighbourhood in
  /// the camera of the patch [m]. Nothing outside the view of `to`, or where the scales differ too much.
  std::optional<PatchPlace> seen_by(const CameraModel& to, const SE3& T_to_from, double depth) const;

  const Eigen::Vector2d& corner() const { return corner_; }

 private:
  Eigen::Vector2d corner_, right_, below_;
};

}  // namespace edged

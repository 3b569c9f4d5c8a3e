// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The reference patches of corners. The drift of optical flow accumulates from image to image. Alignment to the
// reference patch, warped by the motion of the camera since, removes it.
#pragma once

#include <map>
#include <optional>
#include <span>

#include "edged/frontend/patch.hpp"
#include "edged/frontend/patch_outline.hpp"
#include "edged/options/frontend.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"
#include "edged/track.hpp"

namespace edged {

class Templates {
 public:
  Templates(const CameraModel& camera, const PatchConfig& config) : camera_(camera), config_(config) {}

  /// Moves on to the next image. T_cur_prev: camera at the image before to camera now.
  void move(const SE3& T_cur_prev);
  /// Takes reference patches from the newest image for tracks without one or whose patch no longer matches; drops those
  /// of ended tracks.
  void take(const cv::Mat& image, std::span<const Track> tracks);
  /// The position near `pixel` where the newest image matches the reference patch, independent of gain and offset;
  /// nothing without a reference patch or a match. p_C: the expected position of the corner in the camera [m]; its
  /// neighbourhood is assumed at the same depth.
  std::optional<Eigen::Vector2d> align(FeatureId id, const cv::Mat& image, const Eigen::Vector2d& pixel,
                                       const Eigen::Vector3d& p_C) const;
  /// Whether the newest image matches the reference patch.
  void note(FeatureId id, bool fits);
  void clear() { looks_.clear(); }

 private:
  struct Look {
    Patch patch;
    SE3 T_cur_look;  ///< camera at the reference patch to camera now
    PatchOutline outline;
    bool fits = true;  ///< at the last call of match
  };

  CameraModel camera_;
  PatchConfig config_;
  std::map<FeatureId, Look> looks_;
};

}  // namespace edged

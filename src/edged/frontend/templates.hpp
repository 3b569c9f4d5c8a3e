// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The reference patches of corners. Optical flow follows a corner from image to image, and what it drifts by adds up;
// aligned to its reference patch, warped as the camera has moved since, it stays.
#pragma once

#include <map>
#include <optional>
#include <span>

#include "edged/frontend/patch.hpp"
#include "edged/options/frontend.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"
#include "edged/track.hpp"

namespace edged {

class Templates {
 public:
  Templates(const CameraModel& camera, const PatchConfig& config) : camera_(camera), config_(config) {}

  /// The camera has moved on to another image. T_cur_prev: camera at the image before to camera now.
  void move(const SE3& T_cur_prev);
  /// Takes the look, in the newest image, of the tracks that have none or whose own no longer fits; forgets those of
  /// tracks that have ended.
  void take(const cv::Mat& image, std::span<const Track> tracks);
  /// Where near `pixel` the newest image looks as the corner did at first, whatever gain and offset; nothing where it
  /// has no look, or looks otherwise by now. p_C: where the corner is expected in the camera [m]: its neighbours are
  /// taken for as deep as it is.
  std::optional<Eigen::Vector2d> align(FeatureId id, const cv::Mat& image, const Eigen::Vector2d& pixel,
                                       const Eigen::Vector3d& p_C) const;
  /// Whether the newest image looks as the corner did at first.
  void note(FeatureId id, bool fits);
  void clear() { looks_.clear(); }

 private:
  struct Look {
    Patch patch;
    SE3 T_cur_look;                        ///< camera at the look to camera now
    Eigen::Vector2d corner, right, below;  ///< on the unit plane: the corner and two of its neighbours
    bool fits = true;                      ///< as last noted
  };
  std::optional<Eigen::Matrix2d> warp(const Look& look, const Eigen::Vector3d& p_C) const;

  CameraModel camera_;
  PatchConfig config_;
  std::map<FeatureId, Look> looks_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The reference patches of features. The drift of optical flow accumulates from image to image. Alignment to the
// reference patch, warped by the motion of the camera since, removes it.
#pragma once

#include <map>
#include <optional>
#include <span>

#include "edged/frontend/patches/gradient_patch.hpp"
#include "edged/frontend/patches/patch.hpp"
#include "edged/frontend/patches/patch_outline.hpp"
#include "edged/options/frontend.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"
#include "edged/track.hpp"

namespace edged {

/// What the reference patches are compared with.
struct PatchView {
  cv::Mat image;                    ///< CV_8UC1
  BrightnessIncrements increments;  ///< on event frames only
};

/// Where a feature is, and where it was expected.
struct FeatureMotion {
  Eigen::Vector2d pixel;
  Eigen::Vector2d moved;  ///< since the image before [px]
  Eigen::Vector3d p_C;    ///< expected position in the camera [m]; its neighbourhood is assumed at the same depth
};

class ReferencePatches {
 public:
  ReferencePatches(const CameraModel& camera, const PatchConfig& config) : camera_(camera), config_(config) {}

  /// Moves on to the next image. T_cur_prev: camera at the image before to camera now.
  void move(const SE3& T_cur_prev);
  /// Extracts reference patches from the newest image for tracks without one or whose patch no longer matches; drops
  /// those of ended tracks.
  void extract(const PatchView& view, std::span<const Track> tracks);
  /// The position near that of the feature where the newest image matches the reference patch, independent of gain and
  /// offset; nothing without a reference patch or a match. On event frames the gradient patch comes first, which no
  /// change of direction spoils.
  std::optional<Eigen::Vector2d> align(FeatureId id, const PatchView& view, const FeatureMotion& feature) const;
  /// The gradient patch learns from the newest image, where the feature has been found. confirmed: by align.
  void update_gradient(FeatureId id, const PatchView& view, const FeatureMotion& feature, bool confirmed);
  /// Says whether the newest image matches the reference patch.
  void set_fits(FeatureId id, bool fits);
  void clear() { references_.clear(); }
  bool empty() const { return references_.empty(); }

 private:
  struct Reference {
    Patch patch;
    SE3 T_cur_ref;  ///< camera at the reference patch to camera now
    PatchOutline outline;
    GradientPatch gradient;
    bool fits = true;  ///< as of the last set_fits
  };
  std::optional<PatchPlace> place_of(const Reference& reference, const FeatureMotion& feature) const;

  CameraModel camera_;
  PatchConfig config_;
  std::map<FeatureId, Reference> references_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Finds the features of one camera in the image that another camera of the rig took at the same instant: search for the
// patch along the epipolar curve, subpixel alignment independent of gain and offset, check from the other side.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "edged/frontend/patches/patch.hpp"
#include "edged/frontend/patches/patch_outline.hpp"
#include "edged/options/frontend.hpp"
#include "edged/rig.hpp"
#include "edged/se3.hpp"

namespace edged {

/// An image (CV_8UC1) with the model of its camera.
struct StereoImage {
  const CameraModel& camera;
  const cv::Mat& pixels;
};

/// Matches one pair of images; all that it refers to must outlive it.
class StereoMatcher {
 public:
  StereoMatcher(StereoImage from, StereoImage to, const SE3& T_to_from, const StereoConfig& config)
      : from_(from), to_(to), T_to_from_(T_to_from), config_(config) {}

  /// The pixel in `to` of a feature of `from`. depth: its z-depth in `from` [m], where known. Nothing where it is not
  /// in view, does not match, or matches in several places.
  std::optional<Eigen::Vector2d> match(const Eigen::Vector2d& feature, std::optional<double> depth) const;

  /// Distance of a pixel of `to` from the epipolar line of a feature of `from`, both on the unit plane, in pixels on
  /// the axis of `to`.
  double epipolar_px(const Eigen::Vector2d& point_from, const Eigen::Vector2d& point_to) const;

 private:
  std::vector<PatchPlace> candidates(const PatchOutline& outline, std::optional<double> depth) const;
  std::optional<PatchPlace> search(const Patch& patch, const PatchOutline& outline, std::optional<double> depth) const;
  bool returns(const Eigen::Vector2d& found, const PatchPlace& place, const Eigen::Vector2d& feature) const;

  StereoImage from_, to_;
  SE3 T_to_from_;
  StereoConfig config_;
};

}  // namespace edged

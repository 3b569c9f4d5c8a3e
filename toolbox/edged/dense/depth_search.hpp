// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The inverse depth of one pixel of a reference image by search along its epipolar lines in other views.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <span>

#include "edged/rig.hpp"
#include "edged/se3.hpp"

namespace edged {

/// Inverse depths 1 / z [1/m].
struct InverseDepthRange {
  double low, high;
};

/// Another view of what the reference shows: the pixel of (x, y) with inverse depth w is that of H (x, y, 1) + w e.
class EpipolarView {
 public:
  /// smooth: CV_32FC1, which must outlive it, of a pinhole; T_V_R: from the reference to the view.
  EpipolarView(const cv::Mat& smooth, const CameraModel& pinhole, const CameraModel& reference, const SE3& T_V_R);

  struct Place {
    Eigen::Vector2f pixel;
    Eigen::Vector2f by_inverse_depth;  ///< [px m]
    Eigen::Matrix2f by_reference;      ///< its derivative by the pixel of the reference
  };
  /// Nothing where it is not inside the image, or is magnified more than twice.
  std::optional<Place> place(const Eigen::Vector2f& pixel, float inverse_depth) const;

  const cv::Mat& smooth() const { return *smooth_; }

 private:
  const cv::Mat* smooth_;
  Eigen::Matrix3f H_;
  Eigen::Vector3f e_;
};

struct SearchConfig {
  double patch_scale = 1.0;         ///< scale of the patch, which has a radius of 2 px; at most 1.5
  double step_px = 0.75;            ///< step of the first search, in the widest of its views
  int most_steps = 192;             ///< beyond that the steps grow
  std::size_t first_views = 4;      ///< views of the first search, those with the shortest baselines
  float most_first_cost = 0.4F;     ///< 1 - correlation, the mean of its views
  float least_distinction = 0.05F;  ///< ratio of the second-best minimum's cost to the best one's
  float least_correlation = 0.7F;   ///< correlation of a measurement
  double gate_sigmas = 3.0;
  double least_sigma_px = 0.15;  ///< error of one measurement: errors of interpolation
  double common_sigma_px =
      0.2;  ///< error of all measurements together: errors of poses, in the view of the longest baseline
  double most_sigma = 0.04;  ///< sigma of the estimate over the inverse depth
  int least_views = 3;       ///< that agree
};

struct InverseDepth {
  float value, sigma;  ///< [1/m]
  int views;           ///< that agree
};

/// views: by baseline, the shortest first; smooth: of the reference. Nothing where no depth explains the views, or more
/// than one.
std::optional<InverseDepth> search_depth(const cv::Mat& smooth, const cv::Point& pixel,
                                         std::span<const EpipolarView> views, const InverseDepthRange& range,
                                         const SearchConfig& config);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Pyramidal Lucas-Kanade between two images whose pyramids are built once and used twice.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

#include "edged/frontend/tuning.hpp"
#include "edged/options/frontend.hpp"

namespace edged {

/// Half-size levels of an image with their gradients. Copies share the pixels.
class ImagePyramid {
 public:
  /// image: CV_8UC1, not empty. Writes into the memory it already has; levels too small for the window are left out.
  void build(const cv::Mat& image, const KltConfig& config);
  void clear() { levels_.clear(); }
  bool empty() const { return levels_.empty(); }
  const cv::Mat& image() const { return levels_.front(); }  ///< level 0
  const std::vector<cv::Mat>& levels() const { return levels_; }

 private:
  std::vector<cv::Mat> levels_;  // image, gradient, image, gradient, ... the layout of OpenCV
};

struct Flow {
  std::vector<cv::Point2f> points;  ///< [px] in the second image
  std::vector<uchar> found;         ///< 0 where the window left the image or has too little texture
};

/// Follows `points` of `from` to `to`, starting the search at `seeds` (same length), on the levels top_level .. 0, on
/// each until a step is below epsilon_px.
/// Bouguet, "Pyramidal implementation of the Lucas Kanade feature tracker" (2000).
Flow follow(const ImagePyramid& from, const ImagePyramid& to, const std::vector<cv::Point2f>& points,
            const std::vector<cv::Point2f>& seeds, int top_level, const KltConfig& config,
            double epsilon_px = kFrontendTuning.flow_step_px);

/// Normalised cross-correlation in [-1, 1] of the 11x11 patches around a in image_a and b in image_b: independent of
/// gain and offset. 0 when one of them is flat.
double patch_correlation(const cv::Mat& image_a, const cv::Point2f& a, const cv::Mat& image_b, const cv::Point2f& b);

}  // namespace edged

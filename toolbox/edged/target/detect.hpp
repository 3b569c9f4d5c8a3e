// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Finds the corners of a target in a picture.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "edged/target/target.hpp"

namespace edged {

struct TargetCorner {
  int id = 0;  ///< index into TargetLayout::corners
  Eigen::Vector2d pixel;
};

/// A target of which parts are in view, but for the checkerboard, which has to be in view as a whole.
class TargetDetector {
 public:
  /// Throws InputError as TargetSpec::validate.
  explicit TargetDetector(const TargetSpec& spec);

  /// The corners in the picture (CV_8UC1), to a fraction of a pixel; none where the target is not seen, or too little
  /// of it to be sure.
  std::vector<TargetCorner> detect(const cv::Mat& picture) const;

  const TargetSpec& spec() const { return spec_; }
  const TargetLayout& layout() const { return layout_; }

 private:
  std::vector<TargetCorner> checkerboard(const cv::Mat& picture) const;
  std::vector<TargetCorner> april_grid(const cv::Mat& picture) const;
  std::vector<TargetCorner> charuco(const cv::Mat& picture) const;

  TargetSpec spec_;
  TargetLayout layout_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Low-light normalization: prepares dark, noisy images with few grey levels for corners and optical flow.
#pragma once

#include <opencv2/core/mat.hpp>

#include "edged/options/frontend.hpp"

namespace edged {

/// Low-light normalization of the images of one camera. They are smoothed before they are stretched: the mean of a few
/// noisy pixels has more grey levels than any of them. One gain for the whole image, kept until the light has changed:
/// optical flow assumes constant brightness.
class LowLightNormalizer {
 public:
  explicit LowLightNormalizer(const LowLightConfig& config) : config_(config) {}

  /// image: CV_8UC1, not changed; returned unchanged when it is bright enough.
  cv::Mat operator()(const cv::Mat& image);

 private:
  LowLightConfig config_;
  double gain_ = 1.0, black_ = 0.0;
};

}  // namespace edged

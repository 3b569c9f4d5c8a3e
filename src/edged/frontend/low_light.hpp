// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Images in the dark: a few grey levels, noise among them, made fit for corners and optical flow.
#pragma once

#include <opencv2/core/mat.hpp>

#include "edged/options/frontend.hpp"

namespace edged {

/// Brightens the images of one camera where they are dim. They are smoothed before they are stretched: the mean of a
/// few noisy pixels has more grey levels than any of them. One gain for the whole image, held until the light has
/// changed: optical flow takes brightness for constant.
class LowLightNormalizer {
 public:
  explicit LowLightNormalizer(const LowLightConfig& config) : config_(config) {}

  /// image: CV_8UC1, not changed; itself when it is not dim.
  cv::Mat operator()(const cv::Mat& image);

 private:
  LowLightConfig config_;
  double gain_ = 1.0, black_ = 0.0;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/sharpness.hpp"

#include <opencv2/core.hpp>

#include "edged/core/check.hpp"

namespace edged {

double image_variance(const cv::Mat& image) {
  if (image.empty()) return 0.0;
  EDGED_CHECK(image.channels() == 1, "image has {} channels", image.channels());
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation[0] * deviation[0];
}

}  // namespace edged

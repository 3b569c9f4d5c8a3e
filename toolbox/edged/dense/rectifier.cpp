// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/dense/rectifier.hpp"

#include <opencv2/imgproc.hpp>

namespace edged {

Rectifier::Rectifier(const CameraModel& lens, const CameraModel& pinhole)
    : lens_(lens), from_(pinhole.height(), pinhole.width(), CV_32FC2) {
  for (int y = 0; y < from_.rows; ++y) {
    for (int x = 0; x < from_.cols; ++x) {
      const Eigen::Vector2d at = lens.distort_to_pixel(pinhole.pixel_to_point({x, y}));
      from_.at<cv::Vec2f>(y, x) = {static_cast<float>(at.x()), static_cast<float>(at.y())};
    }
  }
}

cv::Mat Rectifier::operator()(const cv::Mat& image) const {
  cv::Mat rectified;
  cv::remap(image, rectified, from_, cv::noArray(), cv::INTER_LINEAR);
  return rectified;
}

}  // namespace edged

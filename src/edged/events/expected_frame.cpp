// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/expected_frame.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "edged/events/tuning.hpp"
#include "edged/options/events.hpp"

namespace edged {
namespace {

constexpr double kLeastMotion_px = 1e-4;

/// Unit vector of the image motion at the middle of the cell; zero where it has no direction.
cv::Vec2f direction(const CameraModel& camera, const SE3& T_later_now, double depth, int x, int y) {
  const Eigen::Vector2d pixel(x + 0.5 * (kEventsTuning.cell_px - 1), y + 0.5 * (kEventsTuning.cell_px - 1));
  const auto later = camera.project(T_later_now * (depth * camera.pixel_to_point(pixel).homogeneous()));
  if (!later || (*later - pixel).norm() < kLeastMotion_px) return {0.0F, 0.0F};
  const Eigen::Vector2f moved = (*later - pixel).normalized().cast<float>();
  return {moved.x(), moved.y()};
}

}  // namespace

cv::Mat expected_event_frame(const cv::Mat& frame, const CameraModel& camera, const std::optional<SE3>& T_later_now,
                             double depth) {
  cv::Mat brightness, slope_x, slope_y, slope;
  frame.convertTo(brightness, CV_32F, 1.0, kEventsTuning.added_grey);
  cv::log(brightness, brightness);
  cv::GaussianBlur(brightness, brightness, {}, kEventsTuning.frame_blur_px);
  cv::Sobel(brightness, slope_x, CV_32F, 1, 0);
  cv::Sobel(brightness, slope_y, CV_32F, 0, 1);
  cv::magnitude(slope_x, slope_y, slope);
  for (int y = 0; T_later_now && y < frame.rows; y += kEventsTuning.cell_px) {
    for (int x = 0; x < frame.cols; x += kEventsTuning.cell_px) {
      const cv::Vec2f along = direction(camera, *T_later_now, depth, x, y);
      if (along == cv::Vec2f(0.0F, 0.0F)) continue;
      const cv::Rect cell(x, y, std::min(kEventsTuning.cell_px, frame.cols - x),
                          std::min(kEventsTuning.cell_px, frame.rows - y));
      slope(cell) = cv::abs(along[0] * slope_x(cell) + along[1] * slope_y(cell));
    }
  }
  cv::GaussianBlur(slope, slope, {}, EventFrameConfig().blur_sigma_px);
  cv::Mat expected;
  slope.convertTo(expected, CV_8U, kEventsTuning.mean_grey / std::max(cv::mean(slope)[0], 1e-6));
  return expected;
}

}  // namespace edged

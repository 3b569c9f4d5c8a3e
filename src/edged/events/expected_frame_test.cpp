// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/expected_frame.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace edged {
namespace {

const CameraModel kFrameCamera(160, 120, 100, 100, 79.5, 59.5);

/// A bright square, whose vertical edges are at 60 and 100, the horizontal ones at 40 and 80.
cv::Mat square_frame(int dark, int bright) {
  cv::Mat frame(120, 160, CV_8UC1, cv::Scalar(dark));
  frame(cv::Rect(60, 40, 40, 40)) = bright;
  return frame;
}

SE3 moved_by(const Eigen::Vector3d& camera_moves) { return {Eigen::Quaterniond::Identity(), -camera_moves}; }

int on_vertical_edge(const cv::Mat& image) { return image.at<std::uint8_t>(60, 60); }
int on_horizontal_edge(const cv::Mat& image) { return image.at<std::uint8_t>(40, 80); }

TEST(ExpectedEventFrame, ShowsEdgesAcrossTheMotion) {
  const cv::Mat frame = square_frame(50, 150);
  const cv::Mat sideways = expected_event_frame(frame, kFrameCamera, moved_by({0.01, 0, 0}), 2.0);
  EXPECT_GT(on_vertical_edge(sideways), 100);
  EXPECT_LT(on_horizontal_edge(sideways), 5);
  const cv::Mat down = expected_event_frame(frame, kFrameCamera, moved_by({0, 0.01, 0}), 2.0);
  EXPECT_LT(on_vertical_edge(down), 5);
  EXPECT_GT(on_horizontal_edge(down), 100);
  EXPECT_EQ(sideways.at<std::uint8_t>(60, 80), 0) << "within the square nothing changes";
}

TEST(ExpectedEventFrame, ShowsAllEdgesWhereTheMotionIsNotKnown) {
  for (const std::optional<SE3>& motion : {std::optional<SE3>(), std::optional(SE3())}) {
    const cv::Mat all = expected_event_frame(square_frame(50, 150), kFrameCamera, motion, 2.0);
    EXPECT_GT(on_vertical_edge(all), 100);
    EXPECT_GT(on_horizontal_edge(all), 100);
  }
}

/// As an event camera, whose events count the change of the logarithm.
TEST(ExpectedEventFrame, DoesNotDependOnExposure) {
  const SE3 motion = moved_by({0.01, 0, 0});
  const cv::Mat dark = expected_event_frame(square_frame(20, 80), kFrameCamera, motion, 2.0);
  const cv::Mat light = expected_event_frame(square_frame(50, 200), kFrameCamera, motion, 2.0);
  EXPECT_LT(cv::norm(dark, light, cv::NORM_INF), 3.0);
  EXPECT_EQ(cv::countNonZero(expected_event_frame(square_frame(90, 90), kFrameCamera, motion, 2.0)), 0);
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/target/detect.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

namespace edged {
namespace {

/// The target seen obliquely on a grey wall, blurred.
struct Scene {
  cv::Mat picture;
  cv::Matx33d pixel_by_metre;
  Eigen::Vector2d pixel(const Eigen::Vector2d& p) const {
    const cv::Vec3d h = pixel_by_metre * cv::Vec3d(p.x(), p.y(), 1.0);
    return {h[0] / h[2], h[1] / h[2]};
  }
};

Scene oblique(const TargetLayout& layout, double turn_deg) {
  constexpr double kPxPerM = 4000.0;
  const cv::Mat flat = draw_target(layout, kPxPerM);
  cv::Mat board;
  const int margin = static_cast<int>(layout.margin * kPxPerM);
  cv::copyMakeBorder(flat, board, margin, margin, margin, margin, cv::BORDER_CONSTANT, cv::Scalar(255));
  constexpr int kWidth = 640, kHeight = 480;
  const double scale = 0.75 * kHeight / std::max(board.rows, board.cols),
               c = std::cos(turn_deg * CV_PI / 180.0) * scale, s = std::sin(turn_deg * CV_PI / 180.0) * scale;
  const double x = 0.5 * board.cols, y = 0.5 * board.rows;
  cv::Matx33d warp(c, -s, 0.5 * kWidth - c * x + s * y, s, c, 0.5 * kHeight - s * x - c * y, 0.0, 0.0, 1.0);
  warp = cv::Matx33d(1, 0, 0, 0, 1, 0, 3e-4, 1e-4, 0.9) * warp;
  Scene out;
  cv::GaussianBlur(board, board, {}, 0.6 / scale);
  cv::warpPerspective(board, out.picture, warp, {kWidth, kHeight}, cv::INTER_LINEAR, cv::BORDER_CONSTANT,
                      cv::Scalar(120));
  // Of a point in metres, y up, to the drawn picture: centres of pixels at whole numbers.
  const cv::Matx33d draw(kPxPerM, 0, margin - 0.5, 0, -kPxPerM, margin + flat.rows - 0.5, 0, 0, 1);
  out.pixel_by_metre = warp * draw;
  return out;
}

void expect_found(const TargetSpec& spec, double turn_deg, double share) {
  const TargetDetector detector(spec);
  const Scene scene = oblique(detector.layout(), turn_deg);
  const auto corners = detector.detect(scene.picture);
  EXPECT_GE(static_cast<double>(corners.size()), share * static_cast<double>(detector.layout().corners.size()))
      << describe(spec) << " " << turn_deg;
  double squares = 0.0;
  for (const TargetCorner& corner : corners) {
    const double off =
        (corner.pixel - scene.pixel(detector.layout().corners.at(static_cast<std::size_t>(corner.id)))).norm();
    EXPECT_LT(off, 0.5) << corner.id << " " << describe(spec) << " " << turn_deg;
    squares += off * off;
  }
  if (!corners.empty()) {
    EXPECT_LT(std::sqrt(squares / static_cast<double>(corners.size())), 0.08) << describe(spec) << " " << turn_deg;
  }
}

TEST(TargetDetector, FindsEveryKindInAnyOrientation) {
  for (const double turn_deg : {0.0, 35.0, 100.0, 180.0, 260.0}) {
    expect_found(usual_target(TargetKind::Checkerboard), turn_deg, 0.99);
    expect_found(usual_target(TargetKind::AprilGrid), turn_deg, 0.8);
    expect_found(usual_target(TargetKind::Charuco), turn_deg, 0.8);
  }
}

TEST(TargetDetector, FindsPartsOfATargetWithTags) {
  for (const TargetKind kind : {TargetKind::AprilGrid, TargetKind::Charuco}) {
    const TargetDetector detector(usual_target(kind));
    Scene scene = oblique(detector.layout(), 10.0);
    scene.picture.colRange(0, 300).setTo(90);
    const auto corners = detector.detect(scene.picture);
    EXPECT_GE(corners.size(), detector.layout().corners.size() / 4) << static_cast<int>(kind);
    for (const TargetCorner& corner : corners)
      EXPECT_LT((corner.pixel - scene.pixel(detector.layout().corners.at(static_cast<std::size_t>(corner.id)))).norm(),
                0.6);
  }
}

TEST(TargetDetector, FindsNothingWhereThereIsNothing) {
  cv::Mat noise(240, 320, CV_8UC1);
  cv::theRNG().state = 7;
  cv::randu(noise, 0, 255);
  for (const TargetKind kind : {TargetKind::Checkerboard, TargetKind::AprilGrid, TargetKind::Charuco}) {
    EXPECT_TRUE(TargetDetector(usual_target(kind)).detect(noise).empty());
    EXPECT_TRUE(TargetDetector(usual_target(kind)).detect(cv::Mat(240, 320, CV_8UC1, cv::Scalar(128))).empty());
  }
}

}  // namespace
}  // namespace edged

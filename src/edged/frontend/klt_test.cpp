// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/klt.hpp"

#include <gtest/gtest.h>

#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

cv::Mat shifted(const cv::Mat& image, double dx, double dy) {
  cv::Mat out;
  const cv::Mat move = (cv::Mat_<double>(2, 3) << 1, 0, dx, 0, 1, dy);
  cv::warpAffine(image, out, move, image.size(), cv::INTER_CUBIC);
  return out;
}

TEST(Klt, RecoversASubpixelShift) {
  const KltConfig config;
  const cv::Mat image = random_texture(240, 180);
  ImagePyramid a, b;
  a.build(image, config);
  b.build(shifted(image, 3.3, -2.6), config);
  const std::vector<cv::Point2f> points{{60, 50}, {120, 90}, {180, 130}};
  const Flow flow = follow(a, b, points, points, config.levels - 1, config);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_TRUE(flow.found[i]);
    EXPECT_NEAR(flow.points[i].x, points[i].x + 3.3, 0.08);
    EXPECT_NEAR(flow.points[i].y, points[i].y - 2.6, 0.08);
  }
}

TEST(Klt, DoesNotFindAFlatWindow) {
  const KltConfig config;
  ImagePyramid flat;
  flat.build(cv::Mat(180, 240, CV_8UC1, cv::Scalar(100)), config);
  const std::vector<cv::Point2f> points{{120, 90}};
  EXPECT_FALSE(follow(flat, flat, points, points, 2, config).found[0]);
}

TEST(Klt, MeasuresTheGradientGateInGreyLevelsPerPixel) {
  // Slopes of 2 grey levels per pixel in both directions, along the two diagonals of neighbouring quadrants.
  cv::Mat image(180, 240, CV_8UC1);
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 240; ++x) image.at<uchar>(y, x) = static_cast<uchar>(std::abs(x - 120) + std::abs(y - 90));
  }
  ImagePyramid pyramid;
  KltConfig config;
  pyramid.build(image, config);
  const std::vector<cv::Point2f> points{{120, 90}};
  config.min_gradient = 0.8;
  EXPECT_TRUE(follow(pyramid, pyramid, points, points, 0, config).found[0]);
  config.min_gradient = 1.2;
  EXPECT_FALSE(follow(pyramid, pyramid, points, points, 0, config).found[0]);
}

TEST(Klt, WorksOnImagesSmallerThanTheWindow) {
  const KltConfig config;
  ImagePyramid a;
  for (const int side : {1, 2, 9, 21, 22, 43}) {
    a.build(random_texture(side, side), config);
    const std::vector<cv::Point2f> points{{side * 0.5F, side * 0.5F}};
    EXPECT_NO_THROW(follow(a, a, points, points, config.levels - 1, config)) << side;
  }
}

TEST(Klt, CorrelationIsBlindToGainAndOffsetAndSeesAnotherPatch) {
  const cv::Mat image = random_texture(240, 180);
  cv::Mat dimmed;
  image.convertTo(dimmed, CV_8U, 0.5, 40.0);
  EXPECT_GT(patch_correlation(image, {100, 80}, dimmed, {100, 80}), 0.99);
  EXPECT_LT(patch_correlation(image, {100, 80}, image, {140, 110}), 0.7);
  EXPECT_LT(patch_correlation(image, {100, 80}, 255 - image, {100, 80}), -0.99);
  EXPECT_EQ(patch_correlation(image, {100, 80}, cv::Mat(180, 240, CV_8UC1, cv::Scalar(9)), {100, 80}), 0.0);
}

}  // namespace
}  // namespace edged

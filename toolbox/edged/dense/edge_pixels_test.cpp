// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Edges of steps and ridges, and none of blank images and noise.
#include "edged/dense/edge_pixels.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace edged {
namespace {

TEST(EdgePixels, AreThinAlongAStepOfAFrame) {
  cv::Mat image(60, 80, CV_8UC1, cv::Scalar(40));
  image.colRange(40, 80).setTo(120);
  const EdgeConfig config;
  const std::vector<cv::Point> pixels = edge_pixels(smoothed(image, config), Modality::Frames, config);
  EXPECT_EQ(pixels.size(), static_cast<std::size_t>(60 - 2 * config.border_px));
  for (const cv::Point& pixel : pixels) EXPECT_NEAR(pixel.x, 39.5, 0.5);
}

TEST(EdgePixels, OfAnEventFrameLieOnTheRidge) {
  cv::Mat image(60, 80, CV_8UC1, cv::Scalar(0));
  image.row(30).setTo(200);
  const EdgeConfig config{.least_strength = 20.0F};
  const std::vector<cv::Point> pixels = edge_pixels(smoothed(image, config), Modality::Events, config);
  EXPECT_EQ(pixels.size(), static_cast<std::size_t>(80 - 2 * config.border_px));
  for (const cv::Point& pixel : pixels) EXPECT_EQ(pixel.y, 30);
}

TEST(EdgePixels, AreNotInBlankImagesOrImagesSmallerThanTheirBorder) {
  const EdgeConfig config;
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    for (const cv::Size size : {cv::Size(80, 60), cv::Size(9, 9)}) {
      const cv::Mat blank(size, CV_8UC1, cv::Scalar(100));
      EXPECT_TRUE(edge_pixels(smoothed(blank, config), modality, config).empty());
    }
  }
}

TEST(EdgePixels, BeyondTheirShareTheStrongestOfEachCellRemain) {
  cv::Mat image(96, 96, CV_8UC1, cv::Scalar(0));
  for (int x = 12; x < 96; x += 8) image.col(x).setTo(x % 16 == 12 ? 250 : 120);
  const EdgeConfig all{.least_strength = 5.0F, .most_share = 1.0}, half{.least_strength = 5.0F, .most_share = 0.025};
  const std::size_t found = edge_pixels(smoothed(image, all), Modality::Events, all).size();
  const std::vector<cv::Point> kept = edge_pixels(smoothed(image, half), Modality::Events, half);
  EXPECT_GT(found, 700U);
  EXPECT_NEAR(static_cast<double>(kept.size()), 0.025 * 96 * 96, 9.0);
  EXPECT_TRUE(std::ranges::all_of(kept, [](const cv::Point& pixel) { return pixel.x % 16 == 12; }));
  for (const int side : {0, 1})
    EXPECT_TRUE(std::ranges::any_of(kept, [&](const cv::Point& pixel) { return pixel.y / 48 == side; }));
}

}  // namespace
}  // namespace edged

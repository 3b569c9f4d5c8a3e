// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/frame_camera.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace edged {
namespace {

constexpr int kSide = 32;

/// Exposure and mean grey level of the last of several frames of a uniform wall.
struct Converged {
  double exposure_ms, level;
};

Converged settle(FrameCamera& camera, float radiance, int frames) {
  const std::vector<float> picture(kSide * kSide, radiance);
  Converged settled{};
  for (int i = 0; i < frames; ++i) {
    settled.exposure_ms = camera.exposure_ms();
    camera.expose(picture, picture, 1e-3 * settled.exposure_ms);
    settled.level = cv::mean(camera.read_out())[0];
  }
  return settled;
}

FrameCameraConfig automatic() {
  FrameCameraConfig config;
  config.auto_exposure = true;
  return config;
}

TEST(FrameCamera, KeepsItsExposureUnlessToldToAdaptIt) {
  FrameCamera camera({}, kSide, kSide, 1);
  EXPECT_EQ(settle(camera, 0.1F, 5).exposure_ms, 8.0);
  EXPECT_EQ(settle(camera, 1.0F, 5).exposure_ms, 8.0);
}

TEST(FrameCamera, SettlesOnTheWantedLevelWhereItsBoundsAllow) {
  FrameCamera camera(automatic(), kSide, kSide, 1);
  for (const float radiance : {0.3F, 2.0F, 0.15F})
    EXPECT_NEAR(settle(camera, radiance, 20).level, 90.0, 3.0) << radiance;
}

TEST(FrameCamera, StaysDarkOrSaturatesAtTheBoundsOfItsExposure) {
  FrameCameraConfig config = automatic();
  config.min_exposure_ms = 1.0;
  FrameCamera camera(config, kSide, kSide, 1);
  const Converged dark = settle(camera, 0.01F, 20);
  EXPECT_EQ(dark.exposure_ms, 25.0);
  EXPECT_NEAR(dark.level, 0.01 * 25.0 * 2500.0 / 80.0, 0.5);
  const Converged bright = settle(camera, 20.0F, 20);
  EXPECT_EQ(bright.exposure_ms, 1.0);
  EXPECT_EQ(bright.level, 255.0);
}

TEST(FrameCamera, AdaptsByAFactorOfTwoAtMost) {
  FrameCamera camera(automatic(), kSide, kSide, 1);
  settle(camera, 0.3F, 20);
  const double before = camera.exposure_ms();
  settle(camera, 30.0F, 1);
  EXPECT_NEAR(camera.exposure_ms(), 0.54 * before, 0.05 * before);
  settle(camera, 0.0F, 1);
  EXPECT_NEAR(camera.exposure_ms(), 2.0 * 0.54 * before, 0.1 * before);
}

TEST(FrameCamera, HasPixelsOfDifferentGainAndDarkCorners) {
  FrameCameraConfig config;
  config.read_noise_electrons = 0.0;
  config.pixel_gain_sigma = 0.1;
  config.vignetting = 0.5;
  FrameCamera camera(config, kSide, kSide, 1);
  const std::vector<float> wall(kSide * kSide, 0.4F);
  constexpr int kImages = 100;
  cv::Mat mean = cv::Mat::zeros(kSide, kSide, CV_64F);
  for (int i = 0; i < kImages; ++i) {
    camera.expose(wall, wall, 8e-3);
    cv::Mat image;
    camera.read_out().convertTo(image, CV_64F, 1.0 / kImages);
    mean += image;
  }
  const double level = 0.4 * 8.0 * 2500.0 / 80.0;
  cv::Scalar middle, spread;
  cv::meanStdDev(mean(cv::Rect(12, 12, 8, 8)), middle, spread);
  EXPECT_NEAR(middle[0], level, 4.0);
  EXPECT_NEAR(spread[0], 0.1 * level, 3.0) << "the same in every image";
  EXPECT_NEAR(cv::mean(mean(cv::Rect(0, 0, 4, 4)))[0], 0.6 * level, 6.0);
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/initialization/stereo_scale.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace edged {
namespace {

const Eigen::Vector3d kBaseline(0.1, 0.0, 0.0);

Eigen::Vector3d seen_from(const Eigen::Vector3d& camera, const Eigen::Vector3d& point) { return point - camera; }

/// The scale by n points at a depth, with a wrong rotation between the cameras about the axis across the baseline.
StereoScale scale_at(double depth_m, int n, double sigma, double turned_rad = 0.0) {
  StereoScale scale;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d point(0.02 * i - 0.5, 0.3, depth_m);
    const Eigen::Vector3d second =
        Eigen::AngleAxisd(turned_rad, Eigen::Vector3d::UnitY()) * seen_from(kBaseline, point);
    scale.add(seen_from(Eigen::Vector3d::Zero(), point), second, kBaseline, sigma);
  }
  return scale;
}

TEST(StereoScale, IsWhatTheParallaxTells) {
  EXPECT_TRUE(std::isinf(StereoScale().sigma()));
  const double parallax = 0.1 / 3.0;
  const double alone = std::hypot(0.01, 5e-4 / parallax, 1.0 / std::sqrt(60 * 100.0));
  EXPECT_NEAR(scale_at(3.0, 60, 1e-4).sigma(), alone, 0.1 * alone) << "with good features the calibration decides";
  EXPECT_NEAR(scale_at(3.0, 60, 5e-3).sigma(), std::sqrt(2.0) * 5e-3 / parallax / std::sqrt(60.0), 0.01);
  EXPECT_TRUE(std::isinf(scale_at(3.0, 10, 1e-4).sigma())) << "few";
}

TEST(StereoScale, IsNotMadeOfNoiseWrongRotationOrWrongMatches) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 1e-3);
  for (int trial = 0; trial < 100; ++trial) {
    StereoScale far;
    for (int i = 0; i < 60; ++i) {
      const double x1 = noise(random), y1 = noise(random), x2 = noise(random), y2 = noise(random);
      far.add({x1, y1, 1.0}, {x2, y2, 1.0}, kBaseline, 1e-3);
    }
    EXPECT_GT(far.sigma(), 0.2);
  }
  EXPECT_TRUE(std::isinf(scale_at(200.0, 60, 1e-3, 0.004).sigma())) << "rays that diverge";
  StereoScale few_wrong = scale_at(200.0, 60, 2e-3);
  few_wrong.add({0.3, 0.0, 1.0}, {0.0, 0.0, 1.0}, kBaseline, 2e-3);
  EXPECT_GT(few_wrong.sigma(), 0.1);
}

TEST(StereoScale, OfTwoCamerasAtOnePlaceIsUnknown) {
  StereoScale scale;
  for (int i = 0; i < 60; ++i) scale.add({0.1, 0.0, 1.0}, {0.0, 0.0, 1.0}, Eigen::Vector3d::Zero(), 1e-3);
  EXPECT_TRUE(std::isinf(scale.sigma()));
}

}  // namespace
}  // namespace edged

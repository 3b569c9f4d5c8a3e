// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/baseline_scale.hpp"

#include <gtest/gtest.h>

#include <random>

#include "edged/se3.hpp"

namespace edged {
namespace {

TEST(BaselineScale, IsWhatTheParallaxTells) {
  BaselineScale scale;
  EXPECT_TRUE(std::isinf(scale.sigma()));
  const Eigen::Vector3d ray(0.1, -0.2, 1.0), beside = so3::exp({0.0, 0.05, 0.0}) * ray;
  for (int i = 0; i < 100; ++i) scale.add(ray, beside, 1e-3);
  EXPECT_EQ(scale.pairs(), 100);
  const double parallax = std::acos(ray.dot(beside) / ray.squaredNorm());
  EXPECT_NEAR(scale.sigma(), std::hypot(0.01, std::sqrt(2.0) * 1e-3 / parallax / 10.0), 1e-4);
}

TEST(BaselineScale, IsNotMadeOfNoise) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 1e-3);
  for (int trial = 0; trial < 100; ++trial) {
    BaselineScale scale;
    const auto far = [&] {
      const double x = noise(random), y = noise(random);
      return Eigen::Vector3d(x, y, 1.0);
    };
    for (int i = 0; i < 60; ++i) {
      const Eigen::Vector3d one = far();
      scale.add(one, far(), 1e-3);
    }
    EXPECT_GT(scale.sigma(), 0.2);
  }
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/patches/gradient_patch.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/core.hpp>

namespace edged {
namespace {

const Eigen::Vector2d kMiddle(80.0, 60.0);

/// The increments of a smooth texture that has moved to `middle`: its gradient times the negative motion.
BrightnessIncrements increments(const Eigen::Vector2d& middle, const Eigen::Vector2d& moved,
                                const Eigen::Matrix2d& A = Eigen::Matrix2d::Identity()) {
  cv::Mat image(120, 160, CV_8UC1);
  const Eigen::Matrix2d back = A.inverse();
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector2d p = back * (Eigen::Vector2d(x, y) - middle);
      const double gx = std::cos(0.6 * p.x()) * std::cos(0.5 * p.y() + 0.3);
      const double gy = std::sin(0.5 * p.x() - 0.4) * std::cos(0.6 * p.y());
      const double change = -Eigen::Vector2d(gx, gy).dot(back * moved);
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(128.0 + 20.0 * change);
    }
  }
  return {image, 1.0};
}

/// Where events of an edge are seen when the feature is at `pixel`: 0.3 px behind it.
Eigen::Vector2d seen_at(const Eigen::Vector2d& pixel, const Eigen::Vector2d& moved) {
  return pixel - 0.3 * moved.normalized();
}

TEST(GradientPatch, FindsACornerThatGoesInAnyDirectionOnceTwoAreKnown) {
  const Eigen::Vector2d right(3.0, 0.0), down(0.0, 2.0);
  GradientPatch patch(increments(seen_at(kMiddle, right), right), kMiddle);
  patch.learn(increments(seen_at(kMiddle + right, right), right), {kMiddle + right}, right, true);
  EXPECT_FALSE(patch.align(increments(kMiddle, down), {kMiddle}, down, {}));  // no motion so far tells of it
  patch.learn(increments(seen_at(kMiddle + down, down), down), {kMiddle + down}, down, false);
  for (const Eigen::Vector2d& moved :
       {right, down, Eigen::Vector2d(-2.0, 0.0), Eigen::Vector2d(1.5, -2.0), Eigen::Vector2d(-0.8, -1.7)}) {
    const Eigen::Vector2d truth = kMiddle + moved;
    const auto found =
        patch.align(increments(seen_at(truth, moved), moved), {truth + Eigen::Vector2d(0.4, -0.3)}, moved, {});
    ASSERT_TRUE(found) << moved.transpose();
    EXPECT_LT((*found - truth).norm(), 0.08) << moved.transpose() << ": " << (*found - truth).transpose();
  }
}

TEST(GradientPatch, TurnsWithTheCamera) {
  const Eigen::Vector2d right(3.0, 0.0), down(0.0, 2.0);
  GradientPatch patch(increments(seen_at(kMiddle, right), right), kMiddle);
  patch.learn(increments(seen_at(kMiddle, right), right), {kMiddle}, right, true);
  patch.learn(increments(seen_at(kMiddle, down), down), {kMiddle}, down, true);
  const Eigen::Matrix2d A = 1.1 * Eigen::Rotation2Dd(0.7).toRotationMatrix();
  const Eigen::Vector2d moved(-1.0, 2.0);
  const auto found =
      patch.align(increments(seen_at(kMiddle, moved), moved, A), {kMiddle + Eigen::Vector2d(0.3, 0.3), A}, moved, {});
  ASSERT_TRUE(found);
  EXPECT_LT((*found - kMiddle).norm(), 0.2);  // the first patch is known 0.3 px behind along its own motion
}

TEST(GradientPatch, FindsNothingWithoutMotionNorInOtherTexture) {
  const Eigen::Vector2d right(3.0, 0.0);
  GradientPatch patch(increments(kMiddle, right), kMiddle);
  EXPECT_FALSE(patch.align(increments(kMiddle, right), {kMiddle}, right, {}));  // its motion is not known yet
  patch.learn(increments(kMiddle, right), {kMiddle}, right, true);
  EXPECT_FALSE(patch.align(increments(kMiddle, right), {kMiddle}, Eigen::Vector2d::Zero(), {}));
  cv::Mat noise(120, 160, CV_8UC1);
  cv::theRNG().state = 7;
  cv::randu(noise, 0, 255);
  EXPECT_FALSE(patch.align({noise, 1.0}, {kMiddle}, right, {}));
  EXPECT_FALSE(patch.align(increments(kMiddle, right), {Eigen::Vector2d(4.0, 60.0)}, right, {}));
}

}  // namespace
}  // namespace edged

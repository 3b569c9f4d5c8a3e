// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/patches/patch.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <opencv2/imgproc.hpp>

namespace edged {
namespace {

/// Smooth and different everywhere: a sum of waves, seen through an affine map of the plane.
cv::Mat scene(const Eigen::Matrix2d& A, const Eigen::Vector2d& middle, double gain = 1.0, double lift = 0.0) {
  cv::Mat image(120, 160, CV_8UC1);
  const Eigen::Matrix2d back = A.inverse();
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector2d p = back * (Eigen::Vector2d(x, y) - middle);
      const double grey = 110.0 + 40.0 * std::sin(0.55 * p.x() + 0.2 * p.y()) * std::cos(0.43 * p.y()) +
                          30.0 * std::sin(0.31 * p.y() - 0.17 * p.x() + 0.01 * p.x() * p.y());
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(gain * grey + lift);
    }
  }
  return image;
}

const Eigen::Matrix2d kSame = Eigen::Matrix2d::Identity();

TEST(Patch, IsFoundWhereItHasGoneToAFractionOfAPixel) {
  const cv::Mat then = scene(kSame, {80, 60});
  const auto patch = cut_patch(then, {{80.3, 59.8}});
  ASSERT_TRUE(patch);
  for (const Eigen::Vector2d& moved :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(1.4, -0.7), Eigen::Vector2d(-3.2, 2.6)}) {
    const cv::Mat now = scene(kSame, Eigen::Vector2d(80, 60) + moved);
    const auto match = match_patch(*patch, now, {80.3, 59.8}, kSame, 6.0, {});
    ASSERT_TRUE(match);
    EXPECT_NEAR(match->pixel.x(), 80.3 + moved.x(), 0.06);
    EXPECT_NEAR(match->pixel.y(), 59.8 + moved.y(), 0.06);
    EXPECT_GT(match->similarity, 0.98);
  }
}

TEST(Patch, IsFoundTurnedNearerAndInOtherLight) {
  const cv::Mat then = scene(kSame, {80, 60});
  const auto patch = cut_patch(then, {{80, 60}});
  Eigen::Matrix2d A;
  A << 1.2, -0.4, 0.3, 1.1;
  const auto match = match_patch(*patch, scene(A, {81.3, 58.9}, 0.6, 50.0), {80, 60}, A, 4.0, {});
  ASSERT_TRUE(match);
  EXPECT_LT((match->pixel - Eigen::Vector2d(81.3, 58.9)).norm(), 0.1);
}

TEST(Patch, IsNotFoundInWhatLooksOtherwiseNorInOneGrey) {
  const auto patch = cut_patch(scene(kSame, {80, 60}), {{80, 60}});
  cv::Mat noise(120, 160, CV_8UC1);
  cv::theRNG().state = 7;
  cv::randu(noise, 0, 255);
  EXPECT_FALSE(match_patch(*patch, noise, {80, 60}, kSame, 6.0, {}));
  EXPECT_FALSE(match_patch(*patch, cv::Mat(120, 160, CV_8UC1, cv::Scalar(90)), {80, 60}, kSame, 6.0, {}));
  EXPECT_FALSE(match_patch(Patch{}, noise, {80, 60}, kSame, 6.0, {}));
}

TEST(Patch, NeverReachesBeyondTheImage) {
  const cv::Mat image = scene(kSame, {80, 60});
  EXPECT_FALSE(cut_patch(image, {{5.0, 60.0}}));
  EXPECT_FALSE(cut_patch(image, {{80.0, 119.0}}));
  EXPECT_FALSE(cut_patch(image, {{std::nan(""), 60.0}}));
  const auto patch = cut_patch(image, {{80, 60}});
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(-50, 20), Eigen::Vector2d(159, 119), Eigen::Vector2d(1e9, 0)}) {
    EXPECT_FALSE(match_patch(*patch, image, place, kSame, 3.0, {}));
  }
}

}  // namespace
}  // namespace edged

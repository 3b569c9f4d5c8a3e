// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/sharpness.hpp"

#include <gtest/gtest.h>

#include "edged/core/check.hpp"

namespace edged {
namespace {

TEST(ImageVariance, IsTheMeanSquaredDistanceFromTheMean) {
  const cv::Mat image = (cv::Mat_<float>(2, 2) << 1, 3, 5, 7);
  EXPECT_NEAR(image_variance(image), 5.0, 1e-12);
  const cv::Mat bytes = (cv::Mat_<unsigned char>(1, 4) << 0, 0, 4, 4);
  EXPECT_NEAR(image_variance(bytes), 4.0, 1e-12);
}

TEST(ImageVariance, IsZeroForFlatAndEmptyImages) {
  EXPECT_EQ(image_variance(cv::Mat(4, 5, CV_32F, cv::Scalar(3.0))), 0.0);
  EXPECT_EQ(image_variance(cv::Mat()), 0.0);
}

TEST(ImageVariance, RefusesSeveralChannels) { EXPECT_THROW(image_variance(cv::Mat(2, 2, CV_8UC3)), CheckError); }

}  // namespace
}  // namespace edged

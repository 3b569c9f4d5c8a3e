// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/texture.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

/// Albedo times 255 at one position, of a footprint of one texel.
float sample(const Texture& texture, float u, float v) {
  const auto one = [](float x) { return PixelValues(PixelValues::Constant(1, x)); };
  return 255.0F * texture.sample(one(u), one(v), one(1.0F))[0];
}

TEST(Texture, IsBilinearBetweenTexelsAlsoWhereItRepeats) {
  const cv::Mat_<std::uint8_t> image = (cv::Mat_<std::uint8_t>(2, 2) << 0, 100, 200, 40);
  const Texture texture(image);
  for (const float u : {0.0F, 2.0F, -4.0F}) {
    for (const float v : {0.0F, 2.0F, -4.0F}) {
      EXPECT_NEAR(sample(texture, u + 0.5F, v + 0.5F), 0.0F, 1e-4F);
      EXPECT_NEAR(sample(texture, u + 1.5F, v + 0.5F), 100.0F, 1e-4F);
      EXPECT_NEAR(sample(texture, u + 0.75F, v + 0.5F), 25.0F, 1e-4F);
      EXPECT_NEAR(sample(texture, u + 1.75F, v + 0.5F), 75.0F, 1e-4F);   // on to the next copy at the right
      EXPECT_NEAR(sample(texture, u + 0.5F, v + 1.75F), 150.0F, 1e-4F);  // below
      EXPECT_NEAR(sample(texture, u + 2.0F, v + 2.0F), 85.0F, 1e-4F);    // between four copies
    }
  }
}

TEST(Texture, OfOneTexelIsTheSameEverywhere) {
  const Texture texture(cv::Mat(1, 1, CV_8UC1, cv::Scalar(180)));
  for (const float u : {-3.2F, 0.0F, 0.9F, 17.5F}) EXPECT_NEAR(sample(texture, u, 2.0F * u), 180.0F, 1e-4F);
}

TEST(Texture, IsBlurredForALargeFootprint) {
  const cv::Mat_<std::uint8_t> image = (cv::Mat_<std::uint8_t>(2, 2) << 0, 100, 200, 40);
  const PixelValues at = PixelValues::Constant(1, 0.5F);
  EXPECT_NEAR(255.0F * Texture(image).sample(at, at, PixelValues::Constant(1, 4.0F))[0], 85.0F, 1e-4F);
}

}  // namespace
}  // namespace edged

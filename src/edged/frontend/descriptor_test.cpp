// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/descriptor.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <random>

#include "edged/frontend/test_scene.hpp"

namespace edged {
namespace {

TEST(Descriptor, CountsTheBitsThatDiffer) {
  const Descriptor none{}, all{~std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0}, ~std::uint64_t{0}};
  EXPECT_EQ(distance(none, all), 256);
  std::mt19937_64 random(1);
  for (int i = 0; i < 100; ++i) {
    const Descriptor a{random(), random(), random(), random()}, b{random(), random(), random(), random()};
    int bits = 0;
    for (std::size_t word = 0; word < a.size(); ++word) bits += std::popcount(a[word] ^ b[word]);
    EXPECT_EQ(distance(a, b), bits);
  }
}

TEST(Descriptor, IsOfTheFeaturesWithAnAngleInsideTheBorder) {
  const cv::Mat image = random_texture(240, 180);
  const std::vector<Eigen::Vector2d> pixels = {{120, 90}, {121, 90}, {3, 90}};
  const std::vector<std::optional<float>> angles_deg = {0.0F, std::nullopt, 0.0F};
  const auto inside = describe(image, pixels, angles_deg, 31), all = describe(image, pixels, angles_deg, 0);
  EXPECT_TRUE(inside[0] && !inside[1] && !inside[2]);
  EXPECT_TRUE(all[0] && !all[1] && all[2]);
  EXPECT_EQ(*inside[0], *all[0]);
}

}  // namespace
}  // namespace edged

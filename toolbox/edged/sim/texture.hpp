// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Procedural textures, and their anti-aliased sampling.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "edged/sim/random.hpp"

namespace edged {

/// Approximate log2 of x > 0: linear between powers of two and continuous, with an error of at most 0.09.
inline float rough_log2(float x) { return static_cast<float>(std::bit_cast<std::uint32_t>(x)) * 0x1.0p-23F - 127.0F; }

/// A square albedo map (0..255) that repeats in both directions, with a pyramid of halved copies.
class Texture {
 public:
  /// image: CV_8UC1, square, side a power of two.
  explicit Texture(const cv::Mat& image);

  int size() const { return 1 << levels_.front().bits; }

  /// Albedo in [0, 1] at texel position (u, v) of the full size, blurred for a footprint of sqrt(2^log2_area) texels:
  /// trilinear, so that it changes smoothly with position and distance.
  float sample(float u, float v, float log2_area) const {
    const float lod = std::clamp(0.5F * log2_area, 0.0F, static_cast<float>(levels_.size() - 1));
    const int fine = static_cast<int>(lod);
    const float share = lod - static_cast<float>(fine);
    const float near = bilinear(levels_[static_cast<std::size_t>(fine)], u, v, fine);
    if (share == 0.0F) return near;
    return near + share * (bilinear(levels_[static_cast<std::size_t>(fine) + 1], u, v, fine + 1) - near);
  }

 private:
  struct Level {
    int bits = 0;  // side is 2^bits
    std::vector<std::uint8_t> texels;
  };

  static float bilinear(const Level& level, float u, float v, int halvings) {
    const float scale = std::bit_cast<float>((127U - static_cast<std::uint32_t>(halvings)) << 23);  // 2^-halvings
    // The offset keeps the sum positive, where truncation is floor; it is a multiple of every side.
    const float x = u * scale - 0.5F + kOffset, y = v * scale - 0.5F + kOffset;
    const auto xi = static_cast<std::uint32_t>(static_cast<std::int32_t>(x));
    const auto yi = static_cast<std::uint32_t>(static_cast<std::int32_t>(y));
    const float fx = x - static_cast<float>(static_cast<std::int32_t>(xi));
    const float fy = y - static_cast<float>(static_cast<std::int32_t>(yi));
    const std::uint32_t mask = (1U << level.bits) - 1U;
    const std::uint32_t x0 = xi & mask, x1 = (xi + 1U) & mask;
    const std::uint8_t* row_0 = level.texels.data() + ((yi & mask) << level.bits);
    const std::uint8_t* row_1 = level.texels.data() + (((yi + 1U) & mask) << level.bits);
    const float a = row_0[x0], b = row_0[x1], c = row_1[x0], d = row_1[x1];
    const float top = a + fx * (b - a), bottom = c + fx * (d - c);
    return (top + fy * (bottom - top)) * (1.0F / 255.0F);
  }

  static constexpr float kOffset = 32768.0F;
  std::vector<Level> levels_;
};

/// Noise of many octaves with checkers, strokes, discs, polygons and letters: corners at all scales.
Texture make_rich_texture(int size, Random& random);

/// The same with fewer marks: a painted wall.
Texture make_plain_texture(int size, Random& random);

/// White with a few dark polygons, discs and stars, none touching another.
Texture make_shapes_texture(int size, Random& random);

}  // namespace edged

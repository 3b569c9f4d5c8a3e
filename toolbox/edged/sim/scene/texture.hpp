// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Procedural textures, and their anti-aliased sampling.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "edged/sim/random.hpp"
#include "edged/sim/sensors/pixel_values.hpp"

namespace edged {

/// A square albedo map (0..255) that repeats in both directions, with a pyramid of halved copies.
class Texture {
 public:
  /// image: CV_8UC1, square, side a power of two.
  explicit Texture(const cv::Mat& image);

  int size() const { return 1 << levels_.front().bits; }

  /// Albedo in [0, 1] at texel positions (u, v) of the full size, each blurred for a footprint of `area` texels:
  /// trilinear, so that it changes smoothly with position and distance.
  PixelValues sample(const PixelValues& u, const PixelValues& v, const PixelValues& area) const;

 private:
  struct Level {
    Level(const std::vector<std::uint8_t>& image, int image_bits);

    int bits;                          // side is 2^bits
    std::vector<std::uint8_t> texels;  // row by row, each followed by its first texel; after the last row, the first
  };

  /// At n positions, on one level of the pyramid.
  void bilinear(std::size_t level, const float* u, const float* v, std::size_t n, float* albedo) const;

  std::vector<Level> levels_;
};

/// Noise of many octaves with checkers, strokes, discs, polygons and letters: corners at all scales.
Texture make_rich_texture(int size, Random& random);

/// A painted wall: fewer marks than make_rich_texture.
Texture make_plain_texture(int size, Random& random);

/// White with a few dark polygons, discs and stars, none touching another.
Texture make_shapes_texture(int size, Random& random);

}  // namespace edged

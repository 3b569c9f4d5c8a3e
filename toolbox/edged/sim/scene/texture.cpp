// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/texture.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// Approximate log2 of x > 0: linear between powers of two and continuous, with an error of at most 0.09.
float rough_log2(float x) { return static_cast<float>(std::bit_cast<std::int32_t>(x)) * 0x1.0p-23F - 127.0F; }

/// Adds value noise of one scale: random values on a grid of `cell` texels, smoothly joined; repeats at the borders.
void add_octave(cv::Mat_<float>& image, int cell, float amplitude, Random& random) {
  const int n = image.rows / cell;
  std::vector<float> grid(static_cast<std::size_t>(n * n));
  for (float& g : grid) g = amplitude * static_cast<float>(random.uniform(-1.0, 1.0));
  const auto at = [&](int x, int y) { return grid[static_cast<std::size_t>((y % n) * n + x % n)]; };
  std::vector<float> smooth;
  for (int texel = 0; texel < cell; ++texel) {
    const float a = static_cast<float>(texel) / static_cast<float>(cell);
    smooth.push_back(a * a * (3.0F - 2.0F * a));
  }
  for (int gy = 0; gy < n; ++gy) {
    for (int gx = 0; gx < n; ++gx) {
      const float top_0 = at(gx, gy), top_1 = at(gx + 1, gy), bottom_0 = at(gx, gy + 1), bottom_1 = at(gx + 1, gy + 1);
      for (int y = 0; y < cell; ++y) {
        float* row = image[gy * cell + y] + gx * cell;
        const float b = smooth[static_cast<std::size_t>(y)];
        for (int x = 0; x < cell; ++x) {
          const float a = smooth[static_cast<std::size_t>(x)];
          const float top = top_0 + a * (top_1 - top_0), bottom = bottom_0 + a * (bottom_1 - bottom_0);
          row[x] += top + b * (bottom - top);
        }
      }
    }
  }
}

cv::Mat clouds(int size, float contrast, Random& random) {
  cv::Mat_<float> sum(size, size, 0.0F);
  for (int cell = size / 4; cell >= 2; cell /= 2)
    add_octave(sum, cell, std::pow(static_cast<float>(cell), 0.45F), random);
  const float scale = contrast / std::pow(static_cast<float>(size), 0.45F);
  const float base = static_cast<float>(random.uniform(80.0, 150.0));
  cv::Mat_<std::uint8_t> image(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      image(y, x) = static_cast<std::uint8_t>(std::clamp(base + scale * sum(y, x), 18.0F, 240.0F));
  return image;
}

std::vector<cv::Point> polygon(const cv::Point& centre, double radius, int corners, Random& random) {
  std::vector<cv::Point> points;
  const double turn = random.uniform(0.0, 2.0 * std::numbers::pi);
  for (int i = 0; i < corners; ++i) {
    const double angle = turn + 2.0 * std::numbers::pi * (i + random.uniform(-0.25, 0.25)) / corners;
    const double r = radius * random.uniform(0.6, 1.0);
    points.emplace_back(centre.x + static_cast<int>(r * std::cos(angle)),
                        centre.y + static_cast<int>(r * std::sin(angle)));
  }
  return points;
}

void draw_checker(cv::Mat& image, const cv::Point& corner, int square, Random& random) {
  const int columns = 3 + random.index(5), rows = 2 + random.index(5);
  const double dark = random.uniform(15, 60), bright = random.uniform(170, 245);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      cv::rectangle(image, cv::Rect(corner.x + x * square, corner.y + y * square, square, square),
                    cv::Scalar((x + y) % 2 == 0 ? dark : bright), cv::FILLED);
}

void draw_text(cv::Mat& image, const cv::Point& at, double scale, Random& random) {
  std::string text;
  for (int i = 3 + random.index(6); i > 0; --i) text += static_cast<char>('A' + random.index(26));
  const double ink = random.uniform() < 0.6 ? random.uniform(12, 50) : random.uniform(200, 250);
  cv::putText(image, text, at, random.index(4), scale, cv::Scalar(ink), std::max(1, static_cast<int>(scale * 1.8)),
              cv::LINE_AA);
}

/// One mark of a random kind. size: approximate size [texels].
void draw_mark(cv::Mat& image, double size, Random& random) {
  const cv::Point at{random.index(image.cols), random.index(image.rows)};
  const cv::Scalar ink(random.uniform() < 0.5 ? random.uniform(12, 70) : random.uniform(160, 245));
  switch (random.index(6)) {
    case 0:
      return draw_checker(image, at, std::max(4, static_cast<int>(size / 5.0)), random);
    case 1:
      return draw_text(image, at, std::max(0.4, size / 60.0), random);
    case 2:
      return cv::circle(image, at, static_cast<int>(0.4 * size), ink, cv::FILLED, cv::LINE_AA);
    case 3: {
      const cv::Point reach{static_cast<int>(size * random.uniform(-2.0, 2.0)),
                            static_cast<int>(size * random.uniform(-2.0, 2.0))};
      return cv::line(image, at, at + reach, ink, 1 + static_cast<int>(size * random.uniform(0.03, 0.15)), cv::LINE_AA);
    }
    default:
      return cv::fillPoly(image, std::vector{polygon(at, 0.7 * size, 3 + random.index(4), random)}, ink, cv::LINE_AA);
  }
}

/// Large marks first, small ones over them. Each size covers the same area.
void draw_marks(cv::Mat& image, double cover, Random& random) {
  for (double mark = 160.0; mark >= 10.0; mark *= 0.7) {
    const int count = static_cast<int>(cover * image.rows * image.cols / (mark * mark));
    for (int i = 0; i < count; ++i) draw_mark(image, mark, random);
  }
}

}  // namespace

Texture::Texture(const cv::Mat& image) {
  const auto side = static_cast<unsigned>(image.rows);
  EDGED_CHECK(image.type() == CV_8UC1 && image.rows == image.cols && std::has_single_bit(side) && side <= 4096,
              "texture of {} x {} texels", image.cols, image.rows);
  std::vector<std::uint8_t> texels;
  for (int y = 0; y < image.rows; ++y) texels.insert(texels.end(), image.ptr(y), image.ptr(y) + image.cols);
  levels_.emplace_back(texels, std::countr_zero(side));
  for (int bits = levels_.back().bits - 1; bits >= 0; --bits) {
    const std::size_t n = std::size_t{1} << bits;
    std::vector<std::uint8_t> coarse(n * n);
    for (std::size_t y = 0; y < n; ++y) {
      for (std::size_t x = 0; x < n; ++x) {
        const std::uint8_t* from = texels.data() + 4 * n * y + 2 * x;
        coarse[n * y + x] = static_cast<std::uint8_t>((from[0] + from[1] + from[2 * n] + from[2 * n + 1] + 2) / 4);
      }
    }
    texels = std::move(coarse);
    levels_.emplace_back(texels, bits);
  }
}

Texture::Level::Level(const std::vector<std::uint8_t>& image, int image_bits) : bits(image_bits) {
  const std::size_t n = std::size_t{1} << bits;
  for (std::size_t y = 0; y <= n; ++y) {
    const auto row = image.begin() + static_cast<std::ptrdiff_t>(y % n * n);
    texels.insert(texels.end(), row, row + static_cast<std::ptrdiff_t>(n));
    texels.push_back(*row);
  }
}

PixelValues Texture::sample(const PixelValues& u, const PixelValues& v, const PixelValues& area) const {
  const float last = static_cast<float>(levels_.size() - 1);
  const PixelValues lod = (0.5F * area.unaryExpr([](float x) { return rough_log2(x); })).max(0.0F).min(last);
  PixelValues albedo(u.size()), coarse(u.size());
  for (Eigen::Index first = 0, next = 0; first < u.size(); first = next) {
    const int level = static_cast<int>(lod[first]);
    while (next < u.size() && static_cast<int>(lod[next]) == level) ++next;
    const std::size_t n = static_cast<std::size_t>(next - first), fine = static_cast<std::size_t>(level);
    bilinear(fine, &u[first], &v[first], n, &albedo[first]);
    bilinear(std::min(fine + 1, levels_.size() - 1), &u[first], &v[first], n, &coarse[first]);
  }
  const PixelValues share = lod - lod.cast<int>().cast<float>();
  return albedo + share * (coarse - albedo);
}

void Texture::bilinear(std::size_t level, const float* u, const float* v, std::size_t n, float* albedo) const {
  const float scale = std::bit_cast<float>((127U - static_cast<std::uint32_t>(level)) << 23);  // 2^-level
  const int bits = levels_[level].bits;
  const std::uint8_t* texels = levels_[level].texels.data();
  const std::int32_t side = std::int32_t{1} << bits, mask = side - 1;
  // The offset keeps the sum positive, where truncation is floor; it is a multiple of every side.
  constexpr float kOffset = 32768.0F;
  std::array<std::int32_t, kMostPixels> at, four;
  std::array<float, kMostPixels> fx, fy;
  for (std::size_t i = 0; i < n; ++i) {
    const float x = u[i] * scale - 0.5F + kOffset, y = v[i] * scale - 0.5F + kOffset;
    const auto xi = static_cast<std::int32_t>(x), yi = static_cast<std::int32_t>(y);
    fx[i] = x - static_cast<float>(xi), fy[i] = y - static_cast<float>(yi);
    at[i] = ((yi & mask) << bits) + (yi & mask) + (xi & mask);
  }
  // Two texels of a row are read as one number: most of the time is spent on reading.
  static_assert(std::endian::native == std::endian::little);
  for (std::size_t i = 0; i < n; ++i) {
    std::uint16_t upper, lower;
    std::memcpy(&upper, texels + at[i], 2), std::memcpy(&lower, texels + at[i] + side + 1, 2);
    four[i] = static_cast<std::int32_t>(upper | std::uint32_t{lower} << 16U);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto texel = [&](int shift) { return static_cast<float>(four[i] >> shift & 255); };
    const float a = texel(0), b = texel(8), c = texel(16), d = texel(24);
    const float top = a + fx[i] * (b - a), bottom = c + fx[i] * (d - c);
    albedo[i] = (top + fy[i] * (bottom - top)) * (1.0F / 255.0F);
  }
}

Texture make_rich_texture(int size, Random& random) {
  cv::Mat image = clouds(size, 130.0F, random);
  draw_marks(image, 0.15, random);
  return Texture(image);
}

Texture make_plain_texture(int size, Random& random) {
  cv::Mat image = clouds(size, 60.0F, random);
  draw_marks(image, 0.015, random);
  return Texture(image);
}

Texture make_shapes_texture(int size, Random& random) {
  cv::Mat image(size, size, CV_8UC1, cv::Scalar(225));
  const int cells = size / 128, cell = size / cells;
  for (int y = 0; y < cells; ++y) {
    for (int x = 0; x < cells; ++x) {
      const cv::Point centre{x * cell + cell / 2 + random.index(17) - 8, y * cell + cell / 2 + random.index(17) - 8};
      const cv::Scalar ink(random.uniform(15, 60));
      const double radius = cell * random.uniform(0.28, 0.42);
      if (random.index(5) == 0) {
        cv::circle(image, centre, static_cast<int>(0.7 * radius), ink, cv::FILLED, cv::LINE_AA);
      } else {
        cv::fillPoly(image, std::vector{polygon(centre, radius, 3 + random.index(5), random)}, ink, cv::LINE_AA);
      }
    }
  }
  return Texture(image);
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/texture.hpp"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// Adds value noise of one scale: random values on a grid of `cell` texels, smoothly joined; repeats at the borders.
void add_octave(cv::Mat_<float>& image, int cell, float amplitude, Random& random) {
  const int size = image.rows, n = size / cell;
  std::vector<float> grid(static_cast<std::size_t>(n * n));
  for (float& g : grid) g = amplitude * static_cast<float>(random.uniform(-1.0, 1.0));
  const auto at = [&](int x, int y) { return grid[static_cast<std::size_t>((y % n) * n + x % n)]; };
  const auto smooth = [cell](int texel) {
    const float a = static_cast<float>(texel % cell) / static_cast<float>(cell);
    return a * a * (3.0F - 2.0F * a);
  };
  for (int y = 0; y < size; ++y) {
    const float b = smooth(y);
    for (int x = 0; x < size; ++x) {
      const int gx = x / cell, gy = y / cell;
      const float a = smooth(x);
      const float top = at(gx, gy) + a * (at(gx + 1, gy) - at(gx, gy));
      const float bottom = at(gx, gy + 1) + a * (at(gx + 1, gy + 1) - at(gx, gy + 1));
      image(y, x) += top + b * (bottom - top);
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
  Level level{.bits = std::countr_zero(side), .texels = {}};
  for (int y = 0; y < image.rows; ++y) level.texels.insert(level.texels.end(), image.ptr(y), image.ptr(y) + image.cols);
  levels_.push_back(std::move(level));
  while (levels_.back().bits > 0) {
    const Level& fine = levels_.back();
    const std::size_t n = std::size_t{1} << (fine.bits - 1);
    Level coarse{.bits = fine.bits - 1, .texels = std::vector<std::uint8_t>(n * n)};
    for (std::size_t y = 0; y < n; ++y) {
      for (std::size_t x = 0; x < n; ++x) {
        const std::uint8_t* from = fine.texels.data() + 4 * n * y + 2 * x;
        coarse.texels[n * y + x] =
            static_cast<std::uint8_t>((from[0] + from[1] + from[2 * n] + from[2 * n + 1] + 2) / 4);
      }
    }
    levels_.push_back(std::move(coarse));
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

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/dense/edge_pixels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace edged {
namespace {

constexpr int kCell_px = 32;

struct Strength {
  cv::Point pixel;
  float value;
};

/// Largest across the edge, among its direct neighbours; 0 where it is not.
float frame_edge(const cv::Mat& smooth, int x, int y) {
  const auto at = [&](int i, int j) { return smooth.at<float>(j, i); };
  const auto squared_slope = [&](int i, int j) {
    const float gx = at(i + 1, j) - at(i - 1, j), gy = at(i, j + 1) - at(i, j - 1);
    return gx * gx + gy * gy;
  };
  const float gx = at(x + 1, y) - at(x - 1, y), gy = at(x, y + 1) - at(x, y - 1), here = gx * gx + gy * gy;
  const bool diagonal = std::min(std::abs(gx), std::abs(gy)) > 0.41F * std::max(std::abs(gx), std::abs(gy));
  const int dx = diagonal ? 1 : std::abs(gx) > std::abs(gy) ? 1 : 0;
  const int dy = diagonal ? (gx * gy > 0.0F ? 1 : -1) : 1 - dx;
  if (here < squared_slope(x + dx, y + dy) || here <= squared_slope(x - dx, y - dy)) return 0.0F;
  return 0.5F * std::sqrt(here);
}

/// Largest across the ridge, in the steepest of four directions.
float event_ridge(const cv::Mat& smooth, int x, int y) {
  constexpr std::array<std::array<int, 2>, 4> kDirections = {{{1, 0}, {0, 1}, {1, 1}, {1, -1}}};
  const auto at = [&](int i, int j) { return smooth.at<float>(j, i); };
  const float here = at(x, y);
  float best = 0.0F;
  for (const auto& [dx, dy] : kDirections) {
    if (here < at(x + dx, y + dy) || here <= at(x - dx, y - dy)) continue;
    best = std::max(best, here - 0.5F * (at(x + 2 * dx, y + 2 * dy) + at(x - 2 * dx, y - 2 * dy)));
  }
  return best;
}

}  // namespace

cv::Mat smoothed(const cv::Mat& image, const EdgeConfig& config) {
  cv::Mat out;
  image.convertTo(out, CV_32F);
  cv::GaussianBlur(out, out, {}, config.sigma_px);
  return out;
}

std::vector<cv::Point> edge_pixels(const cv::Mat& smooth, Modality modality, const EdgeConfig& config) {
  const bool events = modality == Modality::Events;
  const int columns = (smooth.cols + kCell_px - 1) / kCell_px, rows = (smooth.rows + kCell_px - 1) / kCell_px;
  std::vector<std::vector<Strength>> cells(static_cast<std::size_t>(columns * rows));
  std::size_t found = 0;
  for (int y = config.border_px; y < smooth.rows - config.border_px; ++y) {
    for (int x = config.border_px; x < smooth.cols - config.border_px; ++x) {
      const float value = events ? event_ridge(smooth, x, y) : frame_edge(smooth, x, y);
      if (!(value >= config.least_strength)) continue;
      cells[static_cast<std::size_t>(y / kCell_px * columns + x / kCell_px)].push_back({{x, y}, value});
      ++found;
    }
  }
  // Each cell keeps the same share of its edges.
  const double most = config.most_share * smooth.cols * smooth.rows;
  const double kept = std::min(1.0, most / std::max(1.0, static_cast<double>(found)));
  std::vector<cv::Point> pixels;
  for (std::vector<Strength>& cell : cells) {
    const auto count = static_cast<std::ptrdiff_t>(std::ceil(kept * static_cast<double>(cell.size())));
    std::ranges::stable_sort(cell, std::ranges::greater{}, &Strength::value);
    for (auto edge = cell.begin(); edge != cell.begin() + count; ++edge) pixels.push_back(edge->pixel);
  }
  std::ranges::sort(pixels, [](const cv::Point& a, const cv::Point& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  return pixels;
}

}  // namespace edged

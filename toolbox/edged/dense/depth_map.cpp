// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/dense/depth_map.hpp"

#include <algorithm>
#include <cmath>

namespace edged {
namespace {

bool is_same_depth(const DensePoint& a, const DensePoint& b, const CullConfig& config) {
  const double apart = std::abs(a.inverse_depth - b.inverse_depth);
  return apart < config.gate_sigmas * std::hypot(a.sigma, b.sigma) || apart < config.same_share * a.inverse_depth;
}

/// The number of the point of each pixel, -1 without one: CV_32SC1.
cv::Mat numbers_of(const DepthMap& map) {
  cv::Mat numbers(map.pinhole.height(), map.pinhole.width(), CV_32SC1, cv::Scalar(-1));
  for (std::size_t i = 0; i < map.points.size(); ++i)
    numbers.at<int>(map.points[i].y, map.points[i].x) = static_cast<int>(i);
  return numbers;
}

/// The window of pixels around one, inside the image.
cv::Rect around(const cv::Mat& numbers, int x, int y, int reach) {
  return cv::Rect(x - reach, y - reach, 2 * reach + 1, 2 * reach + 1) & cv::Rect(0, 0, numbers.cols, numbers.rows);
}

void add_to(DensePoint& point, float inverse_depth, float sigma, int views) {
  const float a = 1.0F / (point.sigma * point.sigma), b = 1.0F / (sigma * sigma);
  point.inverse_depth = (a * point.inverse_depth + b * inverse_depth) / (a + b);
  point.sigma = 1.0F / std::sqrt(a + b);
  point.views = static_cast<std::uint8_t>(std::min(255, point.views + views));
}

}  // namespace

DepthMap estimate_depth(const DenseView& reference, std::span<const DenseView* const> views,
                        const InverseDepthRange& range, const SearchConfig& search, const EdgeConfig& edges) {
  DepthMap map{reference.t, reference.camera, reference.pinhole, reference.T_O_C, 0, {}};
  std::vector<EpipolarView> lines;
  for (const DenseView* view : views)
    lines.emplace_back(view->smooth, view->pinhole, reference.pinhole, view->T_O_C.inverse() * reference.T_O_C);
  for (const cv::Point& pixel : edge_pixels(reference.smooth, reference.modality, edges)) {
    if (reference.pinhole.is_masked() && !reference.pinhole.contains({pixel.x, pixel.y}, edges.border_px)) continue;
    ++map.edges;
    const std::optional<InverseDepth> found = search_depth(reference.smooth, pixel, lines, range, search);
    if (!found) continue;
    map.points.push_back({static_cast<std::uint16_t>(pixel.x), static_cast<std::uint16_t>(pixel.y), found->value,
                          found->sigma, reference.image.at<std::uint8_t>(pixel),
                          static_cast<std::uint8_t>(found->views)});
  }
  return map;
}

void cull(DepthMap& map, const CullConfig& config) {
  const cv::Mat numbers = numbers_of(map);
  std::vector<DensePoint> kept;
  for (const DensePoint& point : map.points) {
    int same = -1, other = 0;  // without itself
    const cv::Mat window = numbers(around(numbers, point.x, point.y, config.reach_px));
    for (int y = 0; y < window.rows; ++y) {
      for (int x = 0; x < window.cols; ++x) {
        const int number = window.at<int>(y, x);
        if (number < 0) continue;
        ++(is_same_depth(point, map.points[static_cast<std::size_t>(number)], config) ? same : other);
      }
    }
    if (same >= config.least_neighbours && same >= other) kept.push_back(point);
  }
  map.points = std::move(kept);
}

void fuse(DepthMap& older, DepthMap& newer, const CullConfig& config) {
  const cv::Mat numbers = numbers_of(newer);
  const SE3 T_new_old = newer.T_O_C.inverse() * older.T_O_C;
  std::erase_if(older.points, [&](const DensePoint& point) {
    const Eigen::Vector3d p = T_new_old * point.in_camera(older.pinhole);
    const std::optional<Eigen::Vector2d> pixel = newer.pinhole.project(p);
    if (!pixel || !newer.pinhole.contains(*pixel)) return false;
    // Of the distance along a ray that both cameras share: the sigma of its inverse grows with the square of it.
    const auto nearer = static_cast<float>(1.0 / (p.z() * point.inverse_depth));
    const DensePoint moved{0, 0, static_cast<float>(1.0 / p.z()), point.sigma * nearer * nearer, 0, point.views};
    const cv::Mat window = numbers(
        around(numbers, static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y())), 1));
    for (int y = 0; y < window.rows; ++y) {
      for (int x = 0; x < window.cols; ++x) {
        const int number = window.at<int>(y, x);
        if (number < 0) continue;
        DensePoint& same = newer.points[static_cast<std::size_t>(number)];
        if (!is_same_depth(moved, same, config)) continue;
        add_to(same, moved.inverse_depth, moved.sigma, moved.views);
        return true;
      }
    }
    return false;
  });
}

}  // namespace edged

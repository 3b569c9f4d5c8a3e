// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/events/voxel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "edged/core/check.hpp"

namespace edged {
namespace {

cv::Mat plane(const cv::Mat& grid, int bin) {
  return {grid.size[2], grid.size[3], CV_32FC1, const_cast<float*>(grid.ptr<float>(0, bin))};
}

void check_grid(const cv::Mat& grid) {
  EDGED_CHECK(grid.dims == 4 && grid.type() == CV_32FC1 && grid.size[0] == 1 && grid.isContinuous(),
              "a grid of {} dimensions, type {}", grid.dims, grid.type());
}

}  // namespace

cv::Mat voxel_grid(std::span<const Event> events, const cv::Rect& region, int bins) {
  EDGED_CHECK(bins >= 2 && region.width > 0 && region.height > 0, "{} bins, region {} x {}", bins, region.width,
              region.height);
  cv::Mat grid(std::vector<int>{1, bins, region.height, region.width}, CV_32FC1, cv::Scalar(0));
  if (events.empty()) return grid;
  const Timestamp first = events.front().t;
  const Duration span = events.back().t - first;
  const double bins_per_ns = (bins - 1) / static_cast<double>(std::max<Duration::rep>(span.count(), 1));
  const std::ptrdiff_t plane_size = static_cast<std::ptrdiff_t>(region.width) * region.height;
  float* const voxels = grid.ptr<float>();
  for (const Event& event : events) {
    const int x = event.x - region.x, y = event.y - region.y;
    if (x < 0 || y < 0 || x >= region.width || y >= region.height) continue;
    const double t = bins_per_ns * static_cast<double>((event.t - first).count());
    const int bin = std::min(static_cast<int>(t), bins - 1);
    const float later = static_cast<float>(t - bin), polarity = event.positive ? 1.0F : -1.0F;
    float* const voxel = voxels + bin * plane_size + static_cast<std::ptrdiff_t>(y) * region.width + x;
    voxel[0] += polarity * (1.0F - later);
    if (bin + 1 < bins) voxel[plane_size] += polarity * later;
  }
  return grid;
}

void normalise_voxels(cv::Mat& grid) {
  check_grid(grid);
  float* const voxels = grid.ptr<float>();
  const std::size_t n = grid.total();
  double sum = 0.0, squares = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (voxels[i] == 0.0F) continue;
    sum += voxels[i];
    squares += static_cast<double>(voxels[i]) * voxels[i];
    ++count;
  }
  if (count == 0) return;
  const double mean = sum / static_cast<double>(count);
  const double variance = squares / static_cast<double>(count) - mean * mean;
  if (variance <= 1e-9 * mean * mean) return;
  const double scale = 1.0 / std::sqrt(variance);
  for (std::size_t i = 0; i < n; ++i)
    if (voxels[i] != 0.0F) voxels[i] = static_cast<float>((voxels[i] - mean) * scale);
}

Padding padding_to_multiple(int n, int multiple) {
  EDGED_CHECK(n > 0 && multiple > 0, "n {}, multiple {}", n, multiple);
  const int missing = (multiple - n % multiple) % multiple;
  return {(missing + 1) / 2, missing / 2};
}

cv::Mat pad_voxels(const cv::Mat& grid, int multiple) {
  check_grid(grid);
  const int bins = grid.size[1], height = grid.size[2], width = grid.size[3];
  EDGED_CHECK(height >= multiple && width >= multiple, "a grid of {} x {} pixels, multiple {}", width, height,
              multiple);
  const Padding x = padding_to_multiple(width, multiple), y = padding_to_multiple(height, multiple);
  cv::Mat padded(std::vector<int>{1, bins, height + y.before + y.after, width + x.before + x.after}, CV_32FC1);
  for (int bin = 0; bin < bins; ++bin) {
    cv::Mat out = plane(padded, bin);
    cv::copyMakeBorder(plane(grid, bin), out, y.before, y.after, x.before, x.after, cv::BORDER_REFLECT_101);
  }
  return padded;
}

cv::Mat shrink_voxels(const cv::Mat& grid, int factor) {
  check_grid(grid);
  const int bins = grid.size[1], height = grid.size[2], width = grid.size[3];
  EDGED_CHECK(factor >= 1 && height % factor == 0 && width % factor == 0, "a grid of {} x {} pixels, factor {}", width,
              height, factor);
  cv::Mat small(std::vector<int>{1, bins, height / factor, width / factor}, CV_32FC1, cv::Scalar(0));
  const float share = 1.0F / static_cast<float>(factor * factor);
  for (int bin = 0; bin < bins; ++bin) {
    const cv::Mat from = plane(grid, bin);
    cv::Mat to = plane(small, bin);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) to.at<float>(y / factor, x / factor) += share * from.at<float>(y, x);
  }
  return small;
}

cv::Rect central_region(const cv::Size& image, double share) {
  EDGED_CHECK(share > 0.0 && share <= 1.0, "share is {}", share);
  const int width = std::max(1, static_cast<int>(std::lround(share * image.width)));
  const int height = std::max(1, static_cast<int>(std::lround(share * image.height)));
  return {(image.width - width) / 2, (image.height - height) / 2, width, height};
}

cv::Rect grown_region(const cv::Rect& region, int margin_px, const cv::Size& image) {
  const cv::Rect grown(region.x - margin_px, region.y - margin_px, region.width + 2 * margin_px,
                       region.height + 2 * margin_px);
  return grown & cv::Rect(cv::Point(), image);
}

}  // namespace edged

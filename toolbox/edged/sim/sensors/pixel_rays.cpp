// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/pixel_rays.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace edged {
namespace {

constexpr int kBlock = 16;      // [px] side
constexpr double kNear = 0.02;  // [m]

/// Extent on the unit plane of the part of a quadrangle that lies beyond the near plane.
struct Extent {
  double x_0 = std::numeric_limits<double>::infinity(), x_1 = -x_0, y_0 = x_0, y_1 = -x_0;
  void add(const Eigen::Vector3d& p_C) {
    const double x = p_C.x() / p_C.z(), y = p_C.y() / p_C.z();
    x_0 = std::min(x_0, x), x_1 = std::max(x_1, x), y_0 = std::min(y_0, y), y_1 = std::max(y_1, y);
  }
};

Extent project_extent(const Face& face, const SE3& T_C_W) {
  std::array<Eigen::Vector3d, 4> corners;
  constexpr std::array<std::array<double, 2>, 4> kSigns{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  for (std::size_t i = 0; i < 4; ++i)
    corners[i] =
        T_C_W * (face.centre_W + kSigns[i][0] * face.half_u * face.u_W + kSigns[i][1] * face.half_v * face.v_W);
  Extent extent;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3d &a = corners[i], &b = corners[(i + 1) % 4];
    if (a.z() > kNear) extent.add(a);
    if ((a.z() > kNear) != (b.z() > kNear)) extent.add(a + (kNear - a.z()) / (b.z() - a.z()) * (b - a));
  }
  return extent;
}

/// First and last row or column whose extent overlaps [from, to]. Extents need not be sorted.
std::pair<int, int> overlap(const std::vector<float>& low, const std::vector<float>& high, double from, double to) {
  const int n = static_cast<int>(low.size());
  const auto meets = [&](int i) {
    return high[static_cast<std::size_t>(i)] >= from && low[static_cast<std::size_t>(i)] <= to;
  };
  int first = 0, last = n - 1;
  while (first < n && !meets(first)) ++first;
  while (last >= first && !meets(last)) --last;
  return {first, last};
}

}  // namespace

PixelRays::PixelRays(const CameraModel& camera, const LensResidual& residual)
    : width(camera.width()),
      height(camera.height()),
      focal(static_cast<float>(camera.mean_focal())),
      wide(camera.view_limit().has_value()) {
  constexpr float kMax = std::numeric_limits<float>::max();
  constexpr double kStep = 1e-5;
  const auto extents = [kMax](int n) {
    return Extents{std::vector<float>(static_cast<std::size_t>(n), kMax),
                   std::vector<float>(static_cast<std::size_t>(n), -kMax)};
  };
  const auto extend = [](Extents& of, int i, float value) {
    float &low = of.low[static_cast<std::size_t>(i)], &high = of.high[static_cast<std::size_t>(i)];
    low = std::min(low, value), high = std::max(high, value);
  };
  rows_ = extents(height), columns_ = extents(width);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const Eigen::Vector2d pixel = Eigen::Vector2d(u, v) + residual.at(Eigen::Vector2d(u, v));
      const Eigen::Vector3d ray = camera.pixel_to_ray(pixel);
      const Eigen::Vector3f bearing = ray.cast<float>();
      x.push_back(bearing.x()), y.push_back(bearing.y()), z.push_back(bearing.z());
      norm.push_back(bearing.norm());
      extend(rows_, v, bearing.y()), extend(columns_, u, bearing.x());
      if (wide || u % kMotionStride != 0 || v % kMotionStride != 0) continue;
      const Eigen::Vector2d point = ray.head<2>();
      Eigen::Matrix2d slope;
      slope.col(0) = (camera.distort_to_pixel(point + Eigen::Vector2d(kStep, 0)) - pixel) / kStep;
      slope.col(1) = (camera.distort_to_pixel(point + Eigen::Vector2d(0, kStep)) - pixel) / kStep;
      per_point.push_back(slope.cast<float>());
    }
  }
  if (wide) make_blocks();
}

void PixelRays::make_blocks() {
  for (int v = 0; v < height; v += kBlock) {
    for (int u = 0; u < width; u += kBlock) {
      PixelBlock block{{u, std::min(u + kBlock, width) - 1, v, std::min(v + kBlock, height) - 1}, {}};
      for (int row = v; row <= block.pixels.y_1; ++row)
        for (int column = u; column <= block.pixels.x_1; ++column)
          block.bearings.extend(bearing(static_cast<std::size_t>(row * width + column)));
      blocks.push_back(block);
    }
  }
}

PixelBox PixelRays::bounds(const Face& face, const SE3& T_C_W) const {
  if (wide) return {0, width - 1, 0, height - 1};
  const Extent extent = project_extent(face, T_C_W);
  const auto [x_0, x_1] = overlap(columns_.low, columns_.high, extent.x_0, extent.x_1);
  const auto [y_0, y_1] = overlap(rows_.low, rows_.high, extent.y_0, extent.y_1);
  return {x_0, x_1, y_0, y_1};
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The ray of every pixel of a camera, and which pixels may see a face.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "edged/rig.hpp"
#include "edged/sim/scene/scene_parts.hpp"
#include "edged/sim/sensors/lens_residual.hpp"

namespace edged {

struct PixelBox {
  int x_0, x_1, y_0, y_1;  ///< inclusive; empty when x_1 < x_0
};

/// A part of the picture of a wide lens.
struct PixelBlock {
  PixelBox pixels;
  Eigen::AlignedBox3f bearings;  ///< extent of theirs
};

struct PixelRays {
  static constexpr int kMotionStride = 4;

  PixelRays(const CameraModel& camera, const LensResidual& residual);

  /// A box that contains the pixels that may see a face; the whole picture of a wide lens.
  PixelBox bounds(const Face& face, const SE3& T_C_W) const;
  std::size_t count() const { return x.size(); }
  Eigen::Vector3f bearing(std::size_t pixel) const { return {x[pixel], y[pixel], z[pixel]}; }

  int width, height;
  float focal;                             ///< [px]
  bool wide;                               ///< bearings are unit vectors in all directions, else z is 1
  std::vector<float> x, y, z, norm;        ///< bearings (pixel_to_ray), row by row
  std::vector<PixelBlock> blocks;          ///< parts of the picture of a wide lens, else none
  std::vector<Eigen::Matrix2f> per_point;  ///< d pixel / d (x, y): kMotionStride pixels apart, not of a wide lens

 private:
  /// Least and largest coordinate of the bearings in each row or column.
  struct Extents {
    std::vector<float> low, high;
  };
  void make_blocks();

  Extents rows_, columns_;
};

}  // namespace edged

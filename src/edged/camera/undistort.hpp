// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Undistortion of event pixels: from raw pixels to pixels of an ideal pinhole camera.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "edged/rig.hpp"

namespace edged {

/// The ideal pinhole of the same size whose field of view is the largest axis-aligned one that the raw image fills
/// entirely (OpenCV's alpha = 0), with the focal lengths kept positive; of a lens with a view_limit the middle 120
/// degrees at most. Throws InputError when no such camera exists.
CameraModel ideal_pinhole(const CameraModel& raw);

/// Raw pixel -> undistorted pixel of `ideal`, for every pixel once. 8 bytes a pixel, read in the inner loop of the
/// warp.
class UndistortTable {
 public:
  UndistortTable(const CameraModel& raw, const CameraModel& ideal);

  /// Undistorted position [px] of the raw pixel (x, y); x < width, y < height. May lie outside the image. Not a number
  /// where the lens is not used.
  const Eigen::Vector2f& at(int x, int y) const { return table_[static_cast<std::size_t>(y * width_ + x)]; }
  const CameraModel& ideal() const { return ideal_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  CameraModel ideal_;
  int width_, height_;
  std::vector<Eigen::Vector2f> table_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/undistort.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "edged/camera/tuning.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

/// The ideal camera without what the raw one's mask ignores.
CameraModel masked_as(const CameraModel& ideal, const CameraModel& raw) {
  if (!raw.is_masked()) return ideal;
  std::vector<std::uint8_t> used;
  used.reserve(static_cast<std::size_t>(ideal.width()) * static_cast<std::size_t>(ideal.height()));
  for (int y = 0; y < ideal.height(); ++y)
    for (int x = 0; x < ideal.width(); ++x)
      used.push_back(raw.contains(raw.distort_to_pixel(ideal.pixel_to_point({x, y}))) ? 255 : 0);
  return ideal.masked(used);
}

}  // namespace

CameraModel ideal_pinhole(const CameraModel& raw) {
  EDGED_CHECK(raw.width() > 1 && raw.height() > 1, "camera of {} x {} px", raw.width(), raw.height());
  const double right_px = raw.width() - 1.0, bottom_px = raw.height() - 1.0;
  constexpr double kInf = std::numeric_limits<double>::infinity();
  // The box between the innermost points of the four undistorted borders (C5): no border enters it.
  double left = -kInf, right = kInf, top = -kInf, bottom = kInf;
  for (int y = 0; y < raw.height(); ++y) {
    left = std::max(left, raw.pixel_to_point({0.0, y}).x());
    right = std::min(right, raw.pixel_to_point({right_px, y}).x());
  }
  for (int x = 0; x < raw.width(); ++x) {
    top = std::max(top, raw.pixel_to_point({x, 0.0}).y());
    bottom = std::min(bottom, raw.pixel_to_point({x, bottom_px}).y());
  }
  if (raw.view_limit()) {
    left = std::max(left, -kCameraTuning.widest_pinhole), right = std::min(right, kCameraTuning.widest_pinhole);
    top = std::max(top, -kCameraTuning.widest_pinhole), bottom = std::min(bottom, kCameraTuning.widest_pinhole);
  }
  const double fx = right_px / (right - left), fy = bottom_px / (bottom - top);
  if (!(std::isfinite(fx) && std::isfinite(fy) && fx > 0.0 && fy > 0.0)) {
    throw InputError::format(
        "no ideal pinhole for fx {} fy {} cx {} cy {} distortion '{}': its focal lengths would be {} and {}; check the "
        "calibration and the image size {} x {}",
        raw.fx(), raw.fy(), raw.cx(), raw.cy(), to_string(raw.distortion()), fx, fy, raw.width(), raw.height());
  }
  return masked_as({raw.width(), raw.height(), fx, fy, -fx * left, -fy * top}, raw);
}

UndistortTable::UndistortTable(const CameraModel& raw, const CameraModel& ideal)
    : ideal_(ideal), width_(raw.width()), height_(raw.height()) {
  table_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const Eigen::Vector2d pixel(x, y);
      Eigen::Vector2d undistorted = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
      if (raw.contains(pixel)) undistorted = ideal.distort_to_pixel(raw.pixel_to_point(pixel));
      table_.push_back(undistorted.cast<float>());
    }
  }
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/field_of_view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "edged/camera/tuning.hpp"
#include "edged/core/directions.hpp"

namespace edged {
namespace {

constexpr int kSamples = 20;  // along each side of an image

/// Between the rays of two pixels [rad].
double angle_between_pixels(const CameraModel& camera, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector3d u = camera.pixel_to_ray(a), v = camera.pixel_to_ray(b);
  // On opposite sides of the axis; together they may be more than 180 degrees apart.
  if (u.z() < 0.0 || v.z() < 0.0) return std::atan2(u.head<2>().norm(), u.z()) + std::atan2(v.head<2>().norm(), v.z());
  return angle_between(u, v);
}

}  // namespace

FieldOfView field_of_view(const CameraModel& camera) {
  const double right = camera.width() - 1.0, bottom = camera.height() - 1.0;
  const double x = std::clamp(camera.cx(), 0.0, right), y = std::clamp(camera.cy(), 0.0, bottom);
  return {angle_between_pixels(camera, {0.0, y}, {right, y}), angle_between_pixels(camera, {x, 0.0}, {x, bottom}),
          std::max(angle_between_pixels(camera, {0.0, 0.0}, {right, bottom}),
                   angle_between_pixels(camera, {0.0, bottom}, {right, 0.0}))};
}

double axis_slope(const CameraModel& camera) { return 2.0 * camera.mean_focal() / (camera.fx() + camera.fy()); }

double shared_view(const RigCamera& a, const RigCamera& b, double distance_m) {
  const SE3 T_b_a = b.T_B_C.inverse() * a.T_B_C;
  int all = 0, shared = 0;
  for (int row = 0; row < kSamples; ++row) {
    for (int column = 0; column < kSamples; ++column) {
      const Eigen::Vector2d pixel((column + 0.5) * a.model.width() / kSamples - 0.5,
                                  (row + 0.5) * a.model.height() / kSamples - 0.5);
      if (!a.model.contains(pixel)) continue;
      ++all;
      const std::optional<Eigen::Vector2d> there =
          b.model.project(T_b_a * (distance_m * a.model.pixel_to_ray(pixel).normalized()));
      if (there && b.model.contains(*there)) ++shared;
    }
  }
  return all == 0 ? 0.0 : static_cast<double>(shared) / all;
}

bool is_same_lens(const RigCamera& a, const RigCamera& b) {
  return a.model == b.model && a.T_B_C.matrix() == b.T_B_C.matrix();
}

bool have_baseline(const RigCamera& a, const RigCamera& b) {
  return (a.T_B_C.translation() - b.T_B_C.translation()).norm() >= kCameraTuning.min_baseline_m;
}

}  // namespace edged

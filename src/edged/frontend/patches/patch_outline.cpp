// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/patches/patch_outline.hpp"

#include <Eigen/LU>

#include "edged/frontend/tuning.hpp"

namespace edged {
namespace {

constexpr double kNeighbour_px = 4.0;

}  // namespace

PatchOutline::PatchOutline(const CameraModel& camera, const Eigen::Vector2d& feature_px, const Eigen::Vector2d& feature)
    : feature_(feature),
      right_(camera.pixel_to_point(feature_px + Eigen::Vector2d(kNeighbour_px, 0.0))),
      below_(camera.pixel_to_point(feature_px + Eigen::Vector2d(0.0, kNeighbour_px))) {}

std::optional<PatchPlace> PatchOutline::seen_by(const CameraModel& to, const SE3& T_to_from, double depth) const {
  const auto seen = [&](const Eigen::Vector2d& point) { return to.project(T_to_from * (depth * point.homogeneous())); };
  const std::optional<Eigen::Vector2d> feature = seen(feature_), right = seen(right_), below = seen(below_);
  if (!feature || !right || !below) return std::nullopt;
  Eigen::Matrix2d A;
  A << (*right - *feature) / kNeighbour_px, (*below - *feature) / kNeighbour_px;
  const double area = A.determinant();
  return area > 1.0 / kFrontendTuning.max_area_ratio && area < kFrontendTuning.max_area_ratio
             ? std::optional(PatchPlace{*feature, A})
             : std::nullopt;
}

}  // namespace edged

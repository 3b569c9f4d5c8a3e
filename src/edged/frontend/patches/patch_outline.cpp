// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/frontend/patches/patch_outline.hpp"

#include <Eigen/LU>

namespace edged {
namespace {

constexpr double kNeighbour_px = 4.0;
constexpr double kLeastArea = 0.4,
                 kMostArea =
                     2.5;  // contrast of the patch in the image over that of the reference patch: less is not enough

}  // namespace

PatchOutline::PatchOutline(const CameraModel& camera, const Eigen::Vector2d& corner_px, const Eigen::Vector2d& corner)
    : corner_(corner),
      right_(camera.pixel_to_point(corner_px + Eigen::Vector2d(kNeighbour_px, 0.0))),
      below_(camera.pixel_to_point(corner_px + Eigen::Vector2d(0.0, kNeighbour_px))) {}

std::optional<PatchPlace> PatchOutline::seen_by(const CameraModel& to, const SE3& T_to_from, double depth) const {
  const auto seen = [&](const Eigen::Vector2d& point) { return to.project(T_to_from * (depth * point.homogeneous())); };
  const std::optional<Eigen::Vector2d> corner = seen(corner_), right = seen(right_), below = seen(below_);
  if (!corner || !right || !below) return std::nullopt;
  Eigen::Matrix2d A;
  A << (*right - *corner) / kNeighbour_px, (*below - *corner) / kNeighbour_px;
  const double area = A.determinant();
  return area > kLeastArea && area < kMostArea ? std::optional(PatchPlace{*corner, A}) : std::nullopt;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Geometry between views: triangulation and its quality, in any frame A that the poses share.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "edged/se3.hpp"

namespace edged {

/// One observation of a point: the pose of the camera and the point on its unit plane.
struct View {
  SE3 T_A_C;
  Eigen::Vector2d point;
};

struct TriangulatedPoint {
  Eigen::Vector3d p_A;
  double parallax = 0.0;      ///< largest angle between any two of its rays [rad]
  double rms_residual = 0.0;  ///< per coordinate, on the unit plane
};

/// A view made ready for triangulation.
struct Ray {
  Eigen::Matrix3d R_C_A;
  Eigen::Vector3d centre_A;     ///< centre of the camera
  Eigen::Vector2d point;        ///< on its unit plane
  Eigen::Vector3d direction_A;  ///< direction of the point, unit length
};

Ray ray_of(const View& view);

/// Largest angle between any two rays, wherever their centres are [rad].
double largest_angle(std::span<const Ray> rays);

/// Least-squares point of two or more views: linear start, then Gauss-Newton on the unit-plane residual. Nothing when
/// there are fewer than two views, the parallax is below min_parallax [rad], or the point is not in front of all views.
std::optional<TriangulatedPoint> triangulate(std::span<const View> views, double min_parallax = 1e-3);

/// Triangulates two or more rays whose largest angle is known.
std::optional<TriangulatedPoint> triangulate(std::span<const Ray> rays, double parallax);

/// Angle between two rays given on unit planes, after rotating the second by R_1_2 into the first camera's frame [rad].
double ray_angle(const Eigen::Vector2d& point_1, const Eigen::Matrix3d& R_1_2, const Eigen::Vector2d& point_2);

}  // namespace edged

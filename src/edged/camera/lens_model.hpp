// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a model of a lens is: its names, its coefficients and its functions; one file in camera/lenses each.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <string_view>

#include "edged/rig.hpp"

namespace edged {

/// A value and its derivative.
struct ValueAndSlope {
  double value;
  double slope;
};

/// What a distortion does to a point of a plane, and its derivative.
struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d d_point;
};

/// A point at which a radius and its slope are known, moved along its direction to that radius.
inline Distorted moved_to_radius(const Eigen::Vector2d& p, const ValueAndSlope& radius) {
  const double r = p.norm(), tangential = r == 0.0 ? radius.slope : radius.value / r;
  Distorted out{tangential * p, tangential * Eigen::Matrix2d::Identity()};
  if (r > 0.0) out.d_point += (radius.slope - tangential) * (p * p.transpose() / (r * r));
  return out;
}

/// The derivative of a distorted point by the coefficients.
using ByCoefficients = Eigen::Matrix<double, 2, static_cast<int>(kMaxLensCoefficients)>;

/// A lens in two steps, each of which may be absent. First `radius_of_angle`: the radius on a plane of the angle off
/// the axis, which may exceed 90 degrees; without it, the unit plane. Then `distort` on that plane, with
/// `radius_of_radius`, its part that is symmetric about the axis.
struct LensModel {
  DistortionModel model;
  std::string_view name;                                   ///< in calibrations, options and messages
  std::string_view coefficients;                           ///< in their order, those that may be missing in brackets
  std::size_t min_coefficients = 0, max_coefficients = 0;  ///< how many of them: one number or the other
  std::size_t projection_parameters = 0;  ///< a camera model of Kalibr: those that precede the focal lengths there
  std::array<std::string_view, 3> aliases = {};  ///< further names, of other formats, lower case
  std::string_view ros = {}, foxglove = {};      ///< names in camera_info and in Foxglove's CameraCalibration
  ValueAndSlope (*radius_of_angle)(const LensCoefficients& k, double theta) = nullptr;  ///< [rad]
  ValueAndSlope (*radius_of_radius)(const LensCoefficients& k, double r) = nullptr;
  Distorted (*distort)(const LensCoefficients& k, const Eigen::Vector2d& point) = nullptr;
  /// The derivative of both steps, for any lens with coefficients, at a point of the unit plane.
  ByCoefficients (*by_coefficients)(const LensCoefficients& k, const Eigen::Vector2d& point) = nullptr;
};

/// `by_coefficients` of a lens whose radius has these derivatives at the point.
inline ByCoefficients along_radius(const Eigen::Vector2d& point, std::initializer_list<double> radius_by_coefficient) {
  ByCoefficients out = ByCoefficients::Zero();
  const double r = point.norm();
  if (r == 0.0) return out;
  int i = 0;
  for (const double derivative : radius_by_coefficient) out.col(i++) = derivative / r * point;
  return out;
}

}  // namespace edged

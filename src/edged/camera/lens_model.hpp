// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a model of a lens is: its names, its coefficients and its functions; one file in camera/lenses each.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string_view>

#include "edged/rig.hpp"

namespace edged {

using LensCoefficients = std::array<double, 5>;

/// A value and its derivative.
struct Sloped {
  double value;
  double slope;
};

/// What a distortion does to a point of the unit plane, and its derivative.
struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d d_point;
};

/// The derivative of a distorted point by the coefficients.
using ByCoefficients = Eigen::Matrix<double, 2, 5>;

/// A lens that is symmetric about its axis has `radius_of_angle`, and may see beyond 90 degrees. One that is not has
/// radius_of_radius and distort. One without distortion has no function.
struct LensModel {
  DistortionModel model;
  std::string_view name;                      ///< in calibrations, options and messages
  std::string_view coefficients;              ///< in their order, those that may be missing in brackets
  std::size_t fewest = 0, most = 0;           ///< how many of them
  std::array<std::string_view, 3> also = {};  ///< further names, of other formats, lower case
  std::string_view ros = {}, foxglove = {};   ///< names in camera_info and in Foxglove's CameraCalibration
  /// Radius on the distorted unit plane of an angle off the axis [rad].
  Sloped (*radius_of_angle)(const LensCoefficients& k, double theta) = nullptr;
  /// The same of a radius on the unit plane, without what is not symmetric.
  Sloped (*radius_of_radius)(const LensCoefficients& k, double r) = nullptr;
  Distorted (*distort)(const LensCoefficients& k, const Eigen::Vector2d& point) = nullptr;
  /// Of any lens with coefficients. Distortion is linear in them.
  ByCoefficients (*by_coefficients)(const Eigen::Vector2d& point) = nullptr;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Usenko, Demmel and Cremers' lens: two spheres, math.md (C12).
#pragma once

#include <cmath>

#include "edged/camera/lens_model.hpp"

namespace edged {

/// Coefficients: xi alpha.
inline ValueAndSlope double_sphere_radius(const LensCoefficients& k, double theta) {
  const double s = std::sin(theta), c = std::cos(theta), shifted = k[0] + c, second = std::hypot(s, shifted);
  const double depth = k[1] * second + (1.0 - k[1]) * shifted;
  return {s / depth, (c * depth + s * s * (k[1] * k[0] / second + 1.0 - k[1])) / (depth * depth)};
}

inline ByCoefficients double_sphere_by_coefficients(const LensCoefficients& k, const Eigen::Vector2d& p) {
  const double theta = std::atan(p.norm()), s = std::sin(theta);
  const double shifted = k[0] + std::cos(theta), second = std::hypot(s, shifted);
  const double depth = k[1] * second + (1.0 - k[1]) * shifted, by_depth = -s / (depth * depth);
  return along_radius(p, {by_depth * (k[1] * shifted / second + 1.0 - k[1]), by_depth * (second - shifted)});
}

inline constexpr LensModel kDoubleSphere{.model = DistortionModel::DoubleSphere,
                                         .name = "ds",
                                         .coefficients = "xi alpha",
                                         .min_coefficients = 2,
                                         .max_coefficients = 2,
                                         .projection_parameters = 2,
                                         .aliases = {"double_sphere"},
                                         .radius_of_angle = double_sphere_radius,
                                         .by_coefficients = double_sphere_by_coefficients};

}  // namespace edged

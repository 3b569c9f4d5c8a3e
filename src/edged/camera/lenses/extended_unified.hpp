// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Khomutenko, Garcia and Martinet's lens: an ellipsoid in place of the sphere, math.md (C13).
#pragma once

#include <cmath>

#include "edged/camera/lens_model.hpp"

namespace edged {

/// Coefficients: alpha beta.
inline ValueAndSlope extended_unified_radius(const LensCoefficients& k, double theta) {
  const double s = std::sin(theta), c = std::cos(theta), root = std::sqrt(k[1] * s * s + c * c);
  const double depth = k[0] * root + (1.0 - k[0]) * c, d_depth = s * (k[0] * c * (k[1] - 1.0) / root - (1.0 - k[0]));
  return {s / depth, (c * depth - s * d_depth) / (depth * depth)};
}

inline ByCoefficients extended_unified_by_coefficients(const LensCoefficients& k, const Eigen::Vector2d& p) {
  const double theta = std::atan(p.norm()), s = std::sin(theta), c = std::cos(theta);
  const double root = std::sqrt(k[1] * s * s + c * c), depth = k[0] * root + (1.0 - k[0]) * c;
  const double by_depth = -s / (depth * depth);
  return along_radius(p, {by_depth * (root - c), by_depth * k[0] * s * s / (2.0 * root)});
}

inline constexpr LensModel kExtendedUnified{.model = DistortionModel::ExtendedUnified,
                                            .name = "eucm",
                                            .coefficients = "alpha beta",
                                            .min_coefficients = 2,
                                            .max_coefficients = 2,
                                            .projection_parameters = 2,
                                            .radius_of_angle = extended_unified_radius,
                                            .by_coefficients = extended_unified_by_coefficients};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Devernay and Faugeras' lens: the radius is the arctangent of that on the unit plane, math.md (C10).
#pragma once

#include <cmath>

#include "edged/camera/lens_model.hpp"

namespace edged {

inline ValueAndSlope fov_radius(const LensCoefficients& k, double theta) {
  const double s = std::sin(theta), c = std::cos(theta), w = k[0], scale = 2.0 * std::tan(0.5 * w);
  if (w == 0.0) return {s / c, 1.0 / (c * c)};  // the limit
  return {std::atan2(scale * s, c) / w, scale / w / (c * c + scale * scale * s * s)};
}

inline ByCoefficients fov_by_coefficients(const LensCoefficients& k, const Eigen::Vector2d& p) {
  constexpr double kSmall = 1e-3;  // below it, the first term of the series
  const double r = p.norm(), w = k[0];
  if (std::abs(w) < kSmall) return along_radius(p, {w * r * (1.0 / 6.0 - 2.0 / 3.0 * r * r)});
  const double half = std::tan(0.5 * w), u = 2.0 * half * r;
  return along_radius(p, {(r * (1.0 + half * half) / (1.0 + u * u) - std::atan(u) / w) / w});
}

inline constexpr LensModel kFieldOfView{.model = DistortionModel::FieldOfView,
                                        .name = "fov",
                                        .coefficients = "w",
                                        .min_coefficients = 1,
                                        .max_coefficients = 1,
                                        .radius_of_angle = fov_radius,
                                        .by_coefficients = fov_by_coefficients};

}  // namespace edged

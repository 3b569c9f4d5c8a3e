// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Kannala and Brandt's lens: the radius is a polynomial of the angle off the axis, math.md (C3).
#pragma once

#include <cmath>

#include "edged/camera/lens_model.hpp"

namespace edged {

inline ValueAndSlope equidistant_radius(const LensCoefficients& k, double theta) {
  const double t2 = theta * theta;
  return {theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))),
          1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])))};
}

inline ByCoefficients equidistant_by_coefficients(const LensCoefficients&, const Eigen::Vector2d& p) {
  const double theta = std::atan(p.norm()), t2 = theta * theta, t3 = theta * t2;
  return along_radius(p, {t3, t3 * t2, t3 * t2 * t2, t3 * t2 * t2 * t2});
}

inline constexpr LensModel kEquidistant{.model = DistortionModel::Equidistant,
                                        .name = "equidistant",
                                        .coefficients = "k1 k2 k3 k4",
                                        .min_coefficients = 4,
                                        .max_coefficients = 4,
                                        .aliases = {"fisheye", "kannala_brandt", "kb4"},
                                        .ros = "equidistant",
                                        .foxglove = "kannala_brandt",
                                        .radius_of_angle = equidistant_radius,
                                        .by_coefficients = equidistant_by_coefficients};

}  // namespace edged

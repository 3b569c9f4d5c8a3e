// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Mei's sphere, then Kannala and Brandt's polynomial on its plane, as Kalibr combines them, math.md (C11, C3).
#pragma once

#include <cmath>

#include "edged/camera/lenses/equidistant.hpp"
#include "edged/camera/lenses/omni.hpp"

namespace edged {

/// The polynomial, of a radius on the plane of the sphere. Coefficients of the lens: xi k1 k2 k3 k4.
inline ValueAndSlope omni_equidistant_radius(const LensCoefficients& k, double r) {
  const ValueAndSlope of_angle = equidistant_radius({k[1], k[2], k[3], k[4]}, std::atan(r));
  return {of_angle.value, of_angle.slope / (1.0 + r * r)};
}

inline Distorted distort_omni_equidistant(const LensCoefficients& k, const Eigen::Vector2d& p) {
  return moved_to_radius(p, omni_equidistant_radius(k, p.norm()));
}

inline ByCoefficients omni_equidistant_by_coefficients(const LensCoefficients& k, const Eigen::Vector2d& p) {
  const double norm = std::sqrt(1.0 + p.squaredNorm()), depth = 1.0 + k[0] * norm;  // z = 1
  const Eigen::Vector2d on_plane = p / depth;
  ByCoefficients out = ByCoefficients::Zero();
  out.col(0) = distort_omni_equidistant(k, on_plane).d_point * (-norm / (depth * depth) * p);
  out.middleCols<4>(1) = equidistant_by_coefficients({}, on_plane).leftCols<4>();
  return out;
}

inline constexpr LensModel kOmniEquidistant{.model = DistortionModel::OmniEquidistant,
                                            .name = "omni-equidistant",
                                            .coefficients = "xi k1 k2 k3 k4",
                                            .min_coefficients = 5,
                                            .max_coefficients = 5,
                                            .radius_of_angle = omni_radius,
                                            .radius_of_radius = omni_equidistant_radius,
                                            .distort = distort_omni_equidistant,
                                            .by_coefficients = omni_equidistant_by_coefficients};

}  // namespace edged

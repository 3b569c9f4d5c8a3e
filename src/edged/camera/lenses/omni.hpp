// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Mei's lens: a sphere seen from a point xi off its centre, then Brown's distortion, math.md (C11).
#pragma once

#include <cmath>

#include "edged/camera/lenses/radtan.hpp"

namespace edged {

/// The sphere alone. Coefficients: xi k1 k2 p1 p2.
inline ValueAndSlope omni_radius(const LensCoefficients& k, double theta) {
  const double c = std::cos(theta), depth = c + k[0];
  return {std::sin(theta) / depth, (1.0 + k[0] * c) / (depth * depth)};
}

inline LensCoefficients omni_brown(const LensCoefficients& k) { return {k[1], k[2], k[3], k[4]}; }

inline ValueAndSlope omni_brown_radius(const LensCoefficients& k, double r) { return radtan_radius(omni_brown(k), r); }

inline Distorted distort_omni(const LensCoefficients& k, const Eigen::Vector2d& p) {
  return distort_radtan(omni_brown(k), p);
}

inline ByCoefficients omni_by_coefficients(const LensCoefficients& k, const Eigen::Vector2d& p) {
  const double norm = std::sqrt(1.0 + p.squaredNorm()), depth = 1.0 + k[0] * norm;  // z = 1
  const Eigen::Vector2d on_plane = p / depth;
  ByCoefficients out = ByCoefficients::Zero();
  out.col(0) = distort_omni(k, on_plane).d_point * (-norm / (depth * depth) * p);
  out.middleCols<4>(1) = radtan_by_coefficients(omni_brown(k), on_plane).leftCols<4>();
  return out;
}

inline constexpr LensModel kOmni{.model = DistortionModel::Omni,
                                 .name = "omni",
                                 .coefficients = "xi [k1 k2 p1 p2]",
                                 .min_coefficients = 1,
                                 .max_coefficients = 5,
                                 .projection_parameters = 1,
                                 .aliases = {"mei"},
                                 .radius_of_angle = omni_radius,
                                 .radius_of_radius = omni_brown_radius,
                                 .distort = distort_omni,
                                 .by_coefficients = omni_by_coefficients};

}  // namespace edged

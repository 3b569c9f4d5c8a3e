// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// OpenCV's rational lens: a quotient of radial polynomials, tangential distortion as Brown's, math.md (C9).
#pragma once

#include "edged/camera/lenses/radtan.hpp"

namespace edged {

/// The radial factor, and its derivative by r^2. Coefficients: k1 k2 p1 p2 k3 k4 k5 k6.
inline ValueAndSlope rational_factor(const LensCoefficients& k, double r2) {
  const double above = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4])), below = 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  const double d_above = k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[4]);
  const double d_below = k[5] + r2 * (2.0 * k[6] + r2 * 3.0 * k[7]);
  return {above / below, (d_above * below - above * d_below) / (below * below)};
}

inline ValueAndSlope rational_radius(const LensCoefficients& k, double r) {
  const ValueAndSlope factor = rational_factor(k, r * r);
  return {r * factor.value, factor.value + 2.0 * r * r * factor.slope};
}

inline Distorted distort_rational(const LensCoefficients& k, const Eigen::Vector2d& p) {
  const ValueAndSlope factor = rational_factor(k, p.squaredNorm());
  Distorted out = distort_radtan({0.0, 0.0, k[2], k[3]}, p);  // p with its tangential part
  out.point += (factor.value - 1.0) * p;
  out.d_point += 2.0 * factor.slope * p * p.transpose();
  out.d_point.diagonal().array() += factor.value - 1.0;
  return out;
}

inline ByCoefficients rational_by_coefficients(const LensCoefficients& k, const Eigen::Vector2d& p) {
  const double r2 = p.squaredNorm(), below = 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  ByCoefficients out = radtan_by_coefficients(k, p);
  for (const int radial : {0, 1, 4}) out.col(radial) /= below;
  out.col(5) = -rational_factor(k, r2).value * out.col(0);
  out.col(6) = r2 * out.col(5);
  out.col(7) = r2 * out.col(6);
  return out;
}

inline constexpr LensModel kRational{.model = DistortionModel::Rational,
                                     .name = "rational",
                                     .coefficients = "k1 k2 p1 p2 k3 k4 k5 k6",
                                     .min_coefficients = 8,
                                     .max_coefficients = 8,
                                     .aliases = {"rational_polynomial", "thin_prism"},
                                     .ros = "rational_polynomial",
                                     .foxglove = "rational_polynomial",
                                     .radius_of_radius = rational_radius,
                                     .distort = distort_rational,
                                     .by_coefficients = rational_by_coefficients};

}  // namespace edged

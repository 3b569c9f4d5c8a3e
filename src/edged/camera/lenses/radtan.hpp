// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Brown's lens: radial and tangential distortion of the unit plane, math.md (C2).
#pragma once

#include "edged/camera/lens_model.hpp"

namespace edged {

inline Distorted distort_radtan(const LensCoefficients& k, const Eigen::Vector2d& p) {
  const double x = p.x(), y = p.y(), r2 = p.squaredNorm();
  const double radial = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double d_radial = k[0] + r2 * (2.0 * k[1] + r2 * 3.0 * k[4]);  // with respect to r^2
  const Eigen::Vector2d tangential(2.0 * k[2] * x * y + k[3] * (r2 + 2.0 * x * x),
                                   k[2] * (r2 + 2.0 * y * y) + 2.0 * k[3] * x * y);
  Distorted out{radial * p + tangential, 2.0 * d_radial * p * p.transpose()};
  out.d_point.diagonal().array() += radial;
  out.d_point(0, 0) += 2.0 * k[2] * y + 6.0 * k[3] * x;
  out.d_point(0, 1) += 2.0 * k[2] * x + 2.0 * k[3] * y;
  out.d_point(1, 0) += 2.0 * k[2] * x + 2.0 * k[3] * y;
  out.d_point(1, 1) += 6.0 * k[2] * y + 2.0 * k[3] * x;
  return out;
}

/// (C2) without its tangential part.
inline ValueAndSlope radtan_radius(const LensCoefficients& k, double r) {
  const double r2 = r * r;
  return {r * (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))),
          1.0 + r2 * (3.0 * k[0] + r2 * (5.0 * k[1] + r2 * 7.0 * k[4]))};
}

inline ByCoefficients radtan_by_coefficients(const LensCoefficients&, const Eigen::Vector2d& p) {
  const double x = p.x(), y = p.y(), r2 = p.squaredNorm();
  ByCoefficients out = ByCoefficients::Zero();
  out.leftCols<5>() << r2 * p, r2 * r2 * p, Eigen::Vector2d(2.0 * x * y, r2 + 2.0 * y * y),
      Eigen::Vector2d(r2 + 2.0 * x * x, 2.0 * x * y), r2 * r2 * r2 * p;
  return out;
}

inline constexpr LensModel kRadTan{.model = DistortionModel::RadTan,
                                   .name = "radtan",
                                   .coefficients = "k1 k2 p1 p2 [k3]",
                                   .min_coefficients = 4,
                                   .max_coefficients = 5,
                                   .aliases = {"radial-tangential", "radialtangential", "plumb_bob"},
                                   .ros = "plumb_bob",
                                   .foxglove = "plumb_bob",
                                   .radius_of_radius = radtan_radius,
                                   .distort = distort_radtan,
                                   .by_coefficients = radtan_by_coefficients};

}  // namespace edged

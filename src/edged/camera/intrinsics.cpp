// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/intrinsics.hpp"

#include <Eigen/LU>
#include <cmath>

#include "edged/camera/lens_table.hpp"
#include "edged/input_error.hpp"

namespace edged {
namespace {

/// Distortion of a point, by any lens.
Distorted distorted_by(const LensModel& lens, const LensCoefficients& k, const Eigen::Vector2d& p) {
  if (lens.distort) return lens.distort(k, p);
  const double r = p.norm();
  if (!lens.radius_of_angle || r == 0.0) return {p, Eigen::Matrix2d::Identity()};
  const Sloped radius = lens.radius_of_angle(k, std::atan(r));
  const double tangential = radius.value / r, radial = radius.slope / (1.0 + r * r);
  const Eigen::Matrix2d outward = p * p.transpose() / (r * r);
  return {tangential * p, tangential * Eigen::Matrix2d::Identity() + (radial - tangential) * outward};
}

/// Row by row; empty without a mask.
std::vector<std::uint8_t> mask_of(const CameraModel& model) {
  std::vector<std::uint8_t> used;
  if (!model.is_masked()) return used;
  for (int y = 0; y < model.height(); ++y)
    for (int x = 0; x < model.width(); ++x) used.push_back(model.uses(x, y) ? 1 : 0);
  return used;
}

}  // namespace

ByIntrinsics point_by_intrinsics(const CameraModel& given, const CameraModel& model, const Eigen::Vector2d& point) {
  const LensModel& lens = lens_model(model.distortion());
  const Distorted at = distorted_by(lens, model.coefficients(), point);
  ByIntrinsics by_pixel = ByIntrinsics::Zero();  // of the pixel over the focal lengths, at a fixed point
  by_pixel(0, 0) = at.point.x();
  by_pixel(1, 1) = at.point.y();
  by_pixel(0, 2) = given.fx() / model.fx();
  by_pixel(1, 3) = given.fy() / model.fy();
  if (lens.by_coefficients) by_pixel.col(4) = lens.by_coefficients(point).col(0);
  return -at.d_point.inverse() * by_pixel;
}

std::optional<CameraModel> corrected_model(const CameraModel& given, const IntrinsicsCorrection& correction) {
  if (correction.isZero(0.0)) return given;
  LensCoefficients k = given.coefficients();
  if (given.distortion() != DistortionModel::None) k[0] += correction[4];
  try {
    CameraModel model(given.width(), given.height(), given.fx() * std::exp(correction[0]),
                      given.fy() * std::exp(correction[1]), given.cx() + given.fx() * correction[2],
                      given.cy() + given.fy() * correction[3], given.distortion(), k);
    if (const std::optional<double> limit = given.view_limit()) model = model.within(*limit);
    return given.is_masked() ? model.masked(mask_of(given)) : model;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/intrinsics.hpp"

#include <Eigen/LU>
#include <cmath>

#include "edged/camera/lens_table.hpp"
#include "edged/input_error.hpp"

namespace edged {
namespace {

/// Row by row; empty without a mask.
std::vector<std::uint8_t> mask_of(const CameraModel& model) {
  std::vector<std::uint8_t> used;
  if (!model.is_masked()) return used;
  for (int y = 0; y < model.height(); ++y)
    for (int x = 0; x < model.width(); ++x) used.push_back(model.uses(x, y) ? 1 : 0);
  return used;
}

}  // namespace

ByIntrinsics point_by_intrinsics(const CameraModel& given, const Eigen::Vector2d& point) {
  const LensModel& lens = lens_model(given.distortion());
  const Distorted at = distorted(lens, given.coefficients(), point);
  ByIntrinsics by_pixel = ByIntrinsics::Zero();  // of the pixel over the focal lengths, at a fixed point
  by_pixel(0, 0) = at.point.x();
  by_pixel(1, 1) = at.point.y();
  by_pixel(0, 2) = by_pixel(1, 3) = 1.0;
  if (lens.by_coefficients) by_pixel.col(4) = lens.by_coefficients(given.coefficients(), point).col(0);
  return -at.d_point.inverse() * by_pixel;
}

CameraModel corrected_model(const CameraModel& given, const IntrinsicsCorrection& correction) {
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
    return given;
  }
}

}  // namespace edged

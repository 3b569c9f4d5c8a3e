// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/intrinsics.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "edged/camera/lens_table.hpp"
#include "edged/input_error.hpp"

namespace edged {
namespace {

using PinholeRadTan = Eigen::Matrix<double, 8, 1>;  // fx fy cx cy k1 k2 p1 p2

LensCoefficients coefficients_of(const PinholeRadTan& x) { return {x[4], x[5], x[6], x[7]}; }

/// A Gauss-Newton step towards pixel = model(point).
PinholeRadTan fit_step(const PinholeRadTan& x, const std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>>& seen) {
  const LensModel& lens = lens_model(DistortionModel::RadTan);
  Eigen::Matrix<double, 8, 8> H = Eigen::Matrix<double, 8, 8>::Zero();
  PinholeRadTan g = PinholeRadTan::Zero();
  for (const auto& [pixel, point] : seen) {
    const Eigen::Vector2d d = lens.distort(coefficients_of(x), point).point, f = x.head<2>();
    Eigen::Matrix<double, 2, 8> J = Eigen::Matrix<double, 2, 8>::Zero();
    J(0, 0) = d.x(), J(1, 1) = d.y(), J(0, 2) = J(1, 3) = 1.0;
    J.rightCols<4>() = f.asDiagonal() * lens.by_coefficients(coefficients_of(x), point).leftCols<4>();
    H += J.transpose() * J;
    g += J.transpose() * (pixel - f.cwiseProduct(d) - x.segment<2>(2));
  }
  return H.ldlt().solve(g);
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
  const Distorted at = distorted(lens, model.coefficients(), point);
  ByIntrinsics by_pixel = ByIntrinsics::Zero();  // of the pixel over the focal lengths, at a fixed point
  by_pixel(0, 0) = at.point.x();
  by_pixel(1, 1) = at.point.y();
  by_pixel(0, 2) = given.fx() / model.fx();
  by_pixel(1, 3) = given.fy() / model.fy();
  if (const int corrected = corrected_coefficients(model); corrected > 0)
    by_pixel.middleCols(kCoefficientsAt, corrected) =
        lens.by_coefficients(model.coefficients(), point).leftCols(corrected);
  return -at.d_point.inverse() * by_pixel;
}

int corrected_coefficients(const CameraModel& camera) {
  return std::min(kCorrectedCoefficients, static_cast<int>(lens_model(camera.distortion()).max_coefficients));
}

Eigen::Vector2d point_by(const CameraModel& model, const CameraModel& given, const Eigen::Vector2d& point) {
  constexpr int kNewtonSteps = 3;  // from 1e-2: the third leaves rounding errors
  const LensModel& lens = lens_model(model.distortion());
  const Eigen::Vector2d pixel = given.distort_to_pixel(point);
  const Eigen::Vector2d target((pixel.x() - model.cx()) / model.fx(), (pixel.y() - model.cy()) / model.fy());
  Eigen::Vector2d p = point;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Distorted at = distorted(lens, model.coefficients(), p);
    p += at.d_point.inverse() * (target - at.point);
  }
  return p;
}

std::optional<CameraModel> corrected_model(const CameraModel& given, const IntrinsicsCorrection& correction) {
  if (correction.isZero(0.0)) return given;
  LensCoefficients k = given.coefficients();
  for (int i = 0; i < corrected_coefficients(given); ++i)
    k[static_cast<std::size_t>(i)] += correction[kCoefficientsAt + i];
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

std::optional<CameraModel> corrected_image_model(const CameraModel& image, const CameraModel& given,
                                                 const IntrinsicsCorrection& correction) {
  if (image == given) return corrected_model(given, correction);
  if (correction.isZero(0.0)) return image;
  const std::optional<CameraModel> lens = corrected_model(given, correction);
  if (!lens) return std::nullopt;
  constexpr int kAcross = 9, kDown = 7, kSteps = 3;
  std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> seen;
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kDown; ++j) {
      const Eigen::Vector2d pixel(i * (image.width() - 1.0) / (kAcross - 1), j * (image.height() - 1.0) / (kDown - 1));
      seen.emplace_back(pixel, lens->pixel_to_point(given.distort_to_pixel(image.pixel_to_point(pixel))));
    }
  }
  PinholeRadTan x = PinholeRadTan::Zero();
  x.head<4>() << image.fx(), image.fy(), image.cx(), image.cy();
  for (int step = 0; step < kSteps; ++step) x += fit_step(x, seen);
  try {
    return CameraModel(image.width(), image.height(), x[0], x[1], x[2], x[3], DistortionModel::RadTan,
                       coefficients_of(x));
  } catch (const InputError&) {
    return std::nullopt;
  }
}

}  // namespace edged

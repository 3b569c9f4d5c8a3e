// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/calibrate/target_view.hpp"

#include <algorithm>

#include "edged/camera/lens_table.hpp"

namespace edged {

LensCoefficients FreeLens::coefficients() const {
  LensCoefficients k{};
  std::copy(values.begin() + 4, values.end(), k.begin());
  return k;
}

int FreeLens::count() const {
  const LensModel& model = lens_model(distortion);
  return 4 + static_cast<int>(distortion == DistortionModel::RadTan ? model.min_coefficients : model.max_coefficients);
}

CameraModel FreeLens::model(int width, int height) const {
  return {width, height, values[0], values[1], values[2], values[3], distortion, coefficients()};
}

std::optional<Eigen::Vector2d> project_free(const FreeLens& lens, const Eigen::Vector3d& p_C, PixelByPoint* by_point,
                                            PixelByLens* by_lens) {
  constexpr double kFarthest = 11.4;  // on the unit plane: the tangent of 85 degrees
  if (!(p_C.z() > 1e-4)) return std::nullopt;
  const double inverse = 1.0 / p_C.z();
  const Eigen::Vector2d point = inverse * p_C.head<2>();
  if (point.squaredNorm() > kFarthest * kFarthest) return std::nullopt;
  const LensModel& model = lens_model(lens.distortion);
  const LensCoefficients k = lens.coefficients();
  const Distorted at = distorted(model, k, point);
  const Eigen::Vector2d focal(lens.values[0], lens.values[1]);
  if (by_point != nullptr) {
    by_point->leftCols<2>() = inverse * (focal.asDiagonal() * at.d_point);
    by_point->col(2) = -(by_point->leftCols<2>() * point);
  }
  if (by_lens != nullptr) {
    by_lens->setZero();
    (*by_lens)(0, 0) = at.point.x(), (*by_lens)(1, 1) = at.point.y();
    (*by_lens)(0, 2) = (*by_lens)(1, 3) = 1.0;
    if (model.by_coefficients != nullptr)
      by_lens->rightCols<kLensParameters - 4>() = focal.asDiagonal() * model.by_coefficients(k, point);
  }
  return Eigen::Vector2d(focal.cwiseProduct(at.point) + Eigen::Vector2d(lens.values[2], lens.values[3]));
}

}  // namespace edged

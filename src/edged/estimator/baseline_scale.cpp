// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/baseline_scale.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace edged {
namespace {

constexpr double kNoise = 2.0;  // mean square of the parallax of a far point [sigma^2]: two coordinates
constexpr double kDoubt = 4.0;  // two standard deviations of that over the root of the number of pairs
/// Of a baseline, relative: features of one image pair share the error of the calibration.
constexpr double kCalibrated = 0.01;

}  // namespace

void BaselineScale::add(const Eigen::Vector3d& ray_1, const Eigen::Vector3d& ray_2, double sigma) {
  const double parallax = std::atan2(ray_1.cross(ray_2).norm(), ray_1.dot(ray_2));
  information_ += std::pow(parallax / sigma, 2) / 2.0 - kNoise;
  ++pairs_;
}

double BaselineScale::sigma() const {
  const double certain = information_ - kDoubt * std::sqrt(pairs_);
  return certain > 0.0 ? std::hypot(kCalibrated, 1.0 / std::sqrt(certain)) : std::numeric_limits<double>::infinity();
}

}  // namespace edged

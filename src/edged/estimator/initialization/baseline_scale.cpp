// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/initialization/baseline_scale.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace edged {
namespace {

constexpr int kFewestPairs = 15;
constexpr double kMostOfOne = 100.0;  // information of one pair: a wrong match must not count for all
constexpr double kDoubt = 3.5;        // two standard deviations of a far point's information: noise of either sign
// Errors of the calibration that all pairs share: of the baseline, relative, and of the rotation between cameras [rad].
constexpr double kBaselineError = 0.01, kRotationError = 5e-4;

}  // namespace

void BaselineScale::add(const Eigen::Vector3d& ray_1, const Eigen::Vector3d& ray_2, const Eigen::Vector3d& baseline,
                        double sigma) {
  const Eigen::Vector3d normal = baseline.cross(ray_2);  // of the epipolar plane
  if (!(normal.norm() > 1e-6 * ray_2.norm())) return;    // at one place, or at the epipole
  const double parallax = std::atan2(ray_1.cross(ray_2).dot(normal.normalized()), ray_1.dot(ray_2));
  const double squared = parallax * parallax;
  information_ += std::copysign(std::min(squared / (2.0 * sigma * sigma), kMostOfOne), parallax);
  squared_parallax_ += squared;
  ++pairs_;
}

double BaselineScale::sigma() const {
  const double certain = information_ - kDoubt * std::sqrt(pairs_);
  if (pairs_ < kFewestPairs || !(certain > 0.0)) return std::numeric_limits<double>::infinity();
  const double by_rotation = kRotationError * std::sqrt(pairs_ / squared_parallax_);
  return std::hypot(kBaselineError, by_rotation, 1.0 / std::sqrt(certain));
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/initialization/stereo_scale.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "edged/estimator/tuning.hpp"

namespace edged {

void StereoScale::add(const Eigen::Vector3d& ray_1, const Eigen::Vector3d& ray_2, const Eigen::Vector3d& baseline,
                      double sigma) {
  const Eigen::Vector3d normal = baseline.cross(ray_2);  // of the epipolar plane
  if (!(normal.norm() > 1e-6 * ray_2.norm())) return;    // at one place, or at the epipole
  const double parallax = std::atan2(ray_1.cross(ray_2).dot(normal.normalized()), ray_1.dot(ray_2));
  const double squared = parallax * parallax;
  information_ +=
      std::copysign(std::min(squared / (2.0 * sigma * sigma), kStereoScaleTuning.max_information), parallax);
  squared_parallax_ += squared;
  ++pairs_;
}

double StereoScale::sigma() const {
  const double certain = information_ - kStereoScaleTuning.noise_sigmas * std::sqrt(pairs_);
  if (pairs_ < kStereoScaleTuning.min_pairs || !(certain > 0.0)) return std::numeric_limits<double>::infinity();
  const double by_rotation = kStereoScaleTuning.rotation_error * std::sqrt(pairs_ / squared_parallax_);
  return std::hypot(kStereoScaleTuning.baseline_error, by_rotation, 1.0 / std::sqrt(certain));
}

}  // namespace edged

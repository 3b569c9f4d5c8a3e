// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/scale_uncertainty.hpp"

#include <algorithm>
#include <cmath>

#include "edged/pipeline/tuning.hpp"

namespace edged {

void ScaleUncertainty::add(Timestamp t, const Eigen::Vector3d& velocity, const Eigen::Matrix3d& covariance) {
  constexpr double kLongestStep_s = 0.25;
  const double dt = last_ ? std::min(to_seconds(t - *last_), kLongestStep_s) : 0.0;
  last_ = t;
  const double kept = std::exp(-dt / memory_s_), variance = velocity.dot(covariance * velocity);
  travelled_m_ = kept * travelled_m_ + velocity.norm() * dt;
  uncertain_ = kept * uncertain_ + std::sqrt(std::max(0.0, variance)) * dt;
  squares_ = kept * squares_ + velocity.squaredNorm() * dt;
}

std::optional<double> ScaleUncertainty::sigma() const {
  return travelled_m_ < kPipelineTuning.least_travel_m || squares_ <= 0.0 ? std::nullopt
                                                                          : std::optional(uncertain_ / squares_);
}

}  // namespace edged

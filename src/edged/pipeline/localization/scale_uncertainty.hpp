// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How well the scale of an estimate is known: by its velocity and the covariance of that, over the way travelled.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "edged/time.hpp"

namespace edged {

/// Relative standard deviation of the distances travelled. The error of the velocity along the motion is taken as
/// wholly correlated in time, as an error of the scale is: sigma = sum |v| sigma_v dt / sum |v|^2 dt.
class ScaleUncertainty {
 public:
  /// memory_s: older motion counts by a factor e less.
  explicit ScaleUncertainty(double memory_s = std::numeric_limits<double>::infinity()) : memory_s_(memory_s) {}

  /// The velocity [m/s] and its covariance at t, in one frame. In time order; gaps count as little time.
  void add(Timestamp t, const Eigen::Vector3d& velocity, const Eigen::Matrix3d& covariance);

  /// Nothing before the body has travelled kPipelineTuning.least_travel_m: of a shorter way no share means anything.
  std::optional<double> sigma() const;

 private:
  double memory_s_;
  std::optional<Timestamp> last_;
  double travelled_m_ = 0.0, uncertain_ = 0.0, squares_ = 0.0;  ///< sums of |v| [m], |v| sigma and |v|^2 [m^2/s]
};

}  // namespace edged

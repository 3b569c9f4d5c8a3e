// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How well the baselines between cameras determine the scale: features that two cameras observe at one instant.
#pragma once

#include <Eigen/Core>

namespace edged {

/// Collects pairs of rays, of each feature at one instant.
class BaselineScale {
 public:
  /// Directions in one frame, of any length; sigma: of each [rad].
  void add(const Eigen::Vector3d& ray_1, const Eigen::Vector3d& ray_2, double sigma);

  /// Standard deviation of ln scale if it were common to all depths; infinite where the parallax may be noise.
  double sigma() const;
  int pairs() const { return pairs_; }

 private:
  double information_ = 0.0;
  int pairs_ = 0;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How well the baselines between cameras determine the scale: features that two cameras observe at one instant.
#pragma once

#include <Eigen/Core>

namespace edged {

/// Collects pairs of rays, of each feature at one instant.
class StereoScale {
 public:
  /// Directions in one frame, of any length; baseline: from the first camera to the second in that frame [m]; sigma: of
  /// each ray [rad].
  void add(const Eigen::Vector3d& ray_1, const Eigen::Vector3d& ray_2, const Eigen::Vector3d& baseline, double sigma);

  /// Standard deviation of ln scale if it were common to all depths (math.md, A3); infinite with few pairs, or where
  /// the parallax may be noise.
  double sigma() const;

 private:
  double information_ = 0.0;
  double squared_parallax_ = 0.0;  ///< summed [rad^2]
  int pairs_ = 0;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Poses of the body that hang together by the odometry's steps from one to the next and by points of the one that were
// found again from the other: where all of them fit best. What MapFilter does with the past alone, with the future too.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "edged/map/map_errors.hpp"
#include "edged/options/map.hpp"
#include "edged/se3.hpp"

namespace edged {

class PoseGraph {
 public:
  /// A first guess; returns its number. The first one stays where it is.
  std::size_t add_pose(const SE3& T_M_B);
  /// A pose that stays where it is.
  std::size_t add_known_pose(const SE3& T_M_B);
  /// B was seen to lie at T_A_B from A; the covariance is that of B's error then.
  void add_step(std::size_t a, std::size_t b, const SE3& T_A_B, const Matrix6d& covariance);
  /// What was found in the image of a body, of keyframes by their numbers.
  void add_observations(std::size_t body, const SE3& T_B_C, std::span<const MapObservation> observations);
  /// Gauss-Newton; observations that lie far off are weighed down by Cauchy's function, but for the first steps.
  /// Deterministic.
  void solve();

  const std::vector<SE3>& poses() const { return T_M_B_; }

 private:
  struct Step {
    std::size_t a, b;
    SE3 T_A_B;
    Matrix6d information;
  };
  struct View {
    std::size_t body;
    SE3 T_B_C;
    std::vector<MapObservation> observations;
  };
  static constexpr Eigen::Index kKnown = -1;
  class Equations;
  void take(const Step& step, Equations& equations) const;
  void take(const View& view, bool trusting, Equations& equations) const;

  std::vector<SE3> T_M_B_;
  std::vector<Eigen::Index> rows_;  ///< where the unknowns of each pose begin; kKnown: none
  Eigen::Index unknowns_ = 0;
  std::vector<Step> steps_;
  std::vector<View> views_;
};

}  // namespace edged

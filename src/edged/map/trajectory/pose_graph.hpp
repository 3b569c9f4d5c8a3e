// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A pose graph over poses of the body, with odometry between consecutive poses and map matches between any two. A batch
// counterpart of MapFilter, which uses only the past.
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
  /// Adds a pose with an initial value; returns its number. The first pose is fixed.
  std::size_t add_pose(const SE3& T_M_B);
  /// Adds a fixed pose.
  std::size_t add_known_pose(const SE3& T_M_B);
  /// A relative pose T_A_B; the covariance is that of B's error.
  void add_step(std::size_t a, std::size_t b, const SE3& T_A_B, const Matrix6d& covariance);
  void add_gravity(std::size_t body, const GravityObservation& observation);
  /// Map matches in the images at a pose, with keyframes by their numbers; T_B_C: one per image.
  void add_observations(std::size_t body, std::vector<SE3> T_B_C, std::span<const MapObservation> observations);
  /// Gauss-Newton; observations with a Cauchy loss, except in the first steps.
  /// Deterministic.
  void solve();

  const std::vector<SE3>& poses() const { return T_M_B_; }

 private:
  struct Step {
    std::size_t a, b;
    SE3 T_A_B;
    Matrix6d information;
  };
  struct Gravity {
    std::size_t body;
    GravityObservation observation;
  };
  struct View {
    std::size_t body;
    std::vector<SE3> T_B_C;
    std::vector<MapObservation> observations;
  };
  static constexpr Eigen::Index kKnown = -1;
  class Equations;
  void take(const Step& step, Equations& equations) const;
  void take(const Gravity& gravity, Equations& equations) const;
  void take(const View& view, bool trusting, Equations& equations) const;

  std::vector<SE3> T_M_B_;
  std::vector<Eigen::Index> rows_;  ///< first column of each pose; kKnown: fixed
  Eigen::Index unknowns_ = 0;
  std::vector<Step> steps_;
  std::vector<Gravity> gravity_;
  std::vector<View> views_;
};

}  // namespace edged

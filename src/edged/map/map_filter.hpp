// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where the body and the keyframes are in the map M: one Kalman filter over all their poses. The odometry moves the
// body on; map matches tie it to the keyframes, and all that hangs together moves. The odometry
// itself learns nothing of it: no measurement counts twice there, and a wrong map does it no harm.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "edged/map/map_errors.hpp"
#include "edged/options/map.hpp"
#include "edged/se3.hpp"
#include "edged/time.hpp"

namespace edged {

/// T_M_O is OdomToMap's: the filter takes it and gives its correction.
class MapFilter {
 public:
  explicit MapFilter(const MapFilterConfig& config) : config_(config) {}

  /// A new frame O of the odometry: where it lies in M is a guess with these sigmas [m], [rad] of position and yaw.
  void restart(const SE3& T_M_O, const SE3& T_O_B, Timestamp t, double position_sigma, double yaw_sigma);
  /// The odometry has come to T_O_B. drift: how much more it drifts than the options say.
  void predict(const SE3& T_M_O, const SE3& T_O_B, Timestamp t, double drift = 1.0);
  /// A keyframe of the odometry, at T_O_K: it comes last in keyframes().
  void add_keyframe(const SE3& T_M_O, const SE3& T_O_K, Timestamp t);
  /// The keyframes of another run, in place of those there are, and how well they are known: six rows each.
  void load(std::vector<SE3> T_M_K, const Eigen::MatrixXd& covariance);
  /// The others' order stays.
  void remove_keyframe(std::size_t keyframe);
  /// Fits all poses to the observations; expected: how many could have been found. Returns T_M_O as corrected; nothing
  /// where they do not agree, and nothing has changed then.
  std::optional<SE3> update(std::span<const MapObservation> observations, std::size_t expected, const SE3& T_B_C);

  const SE3& T_M_B() const { return T_M_B_; }
  const std::vector<SE3>& keyframes() const { return T_M_K_; }
  /// Of the body against the map's first keyframe.
  Matrix6d covariance() const { return P_.topLeftCorner<6, 6>(); }
  Eigen::MatrixXd keyframe_covariance() const;
  /// How far a observation may lie from where it is expected on the unit plane: one sigma.
  double expected_error(const MapObservation& observation, const SE3& T_B_C) const;

 private:
  std::optional<LinearizedObservation> linearise(const MapObservation& observation, const SE3& T_B_C) const;
  Eigen::Matrix2d expected_covariance(const LinearizedObservation& row, std::size_t keyframe) const;
  /// Normal equations of the body and of the keyframes in `place`, by where those begin.
  struct Information {
    std::map<std::size_t, Eigen::Index> place;
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
  };
  Information gather(std::span<const MapObservation> observations, std::span<const LinearizedObservation> rows) const;
  double misfit(std::span<const MapObservation> observations, std::span<const LinearizedObservation> rows,
                const Eigen::VectorXd& error) const;
  SE3 correct(const Eigen::VectorXd& error);
  void shrink(std::span<const Eigen::Index> m, const Eigen::MatrixXd& P_m, const Eigen::MatrixXd& A);

  MapFilterConfig config_;
  SE3 T_O_B_, T_M_B_;
  Timestamp t_;
  std::vector<SE3> T_M_K_;
  Eigen::MatrixXd P_ = Eigen::MatrixXd::Zero(6, 6);  ///< body first, then the keyframes
};

}  // namespace edged

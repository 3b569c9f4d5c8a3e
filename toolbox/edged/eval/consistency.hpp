// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Consistency of an estimator: its errors relative to its covariances.
#pragma once

#include <array>
#include <vector>

#include "edged/state.hpp"

namespace edged {

/// An estimated state of the body with its covariance relative to a pose whose position and yaw are exact.
struct StateCovarianceSample {
  Timestamp t;
  SE3 T_W_B;
  Eigen::Vector3d v_W;
  StateCovariance covariance;
  bool good = true;   ///< the status was Good
  int reference = 0;  ///< number of that pose: that of the first start, then of each relocalization
};

/// A normal error of three dimensions has a mean of 3 and shares of 99.73 %. No share where there are no poses.
struct NormalizedErrors {
  double mean_nees = 0.0;  ///< e' P^-1 e
  double max_nees = 0.0;
  double within = 1.0;                                    ///< share of the poses whose NEES is that of 99.73 % or less
  Eigen::Vector3d axes_within = Eigen::Vector3d::Ones();  ///< share within three sigmas on each axis
};

/// Mean NEES of the poses within 0.25 s of an instant.
struct NeesAt {
  double since_start_s;  ///< since the first Good pose
  double position, rotation;
  double velocity;  ///< NaN where it is not known
};

struct TimeSpan {
  Timestamp begin, end;
};

/// One position error, estimate minus truth, aligned as below, with its limit.
struct PoseErrorSample {
  Timestamp t;
  Eigen::Vector3d error, sigma;  ///< in the true W [m]
};

struct Consistency {
  std::size_t poses = 0, references = 0;
  NormalizedErrors position, rotation, velocity;
  std::vector<NeesAt> at;  ///< some instants of the first start: kNeesAt_s, as far as the run reaches
  /// Time spans of silent divergence: for more than 0.5 s all poses are Good, but position or rotation are beyond three
  /// sigma on an axis.
  std::vector<TimeSpan> silent;
  std::vector<PoseErrorSample> errors;  ///< errors of each pose

  double silent_s() const;
};

/// Instants for NeesAt. Averages over many runs at one instant are those of a Monte Carlo test (bench/consistency).
inline constexpr std::array kNeesAt_s = {5.0, 20.0, 60.0, 300.0};

/// Compares samples with the ground truth: the same body on the same clock, both in time order. The first Good pose of
/// each reference is aligned with the truth, position and yaw; poses before it are ignored. As that pose is not exact
/// either (after a start in motion it is centimetres off), its covariance is added to that of each error. Errors below
/// 0.1 mm, 0.1 mrad and 1 mm/s are never too large. The true velocity is that of neighbouring true poses: where they
/// are noisy, as those of a motion capture system, its errors say little. Only position and rotation decide what is
/// silent.
Consistency check_consistency(const Trajectory& truth, const std::vector<StateCovarianceSample>& samples);

}  // namespace edged

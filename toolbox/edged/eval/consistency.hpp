// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether an estimator knows how far it is from the truth: its errors in units of what it says about them.
#pragma once

#include <vector>

#include "edged/state.hpp"

namespace edged {

/// A pose of the body as estimated, and how well the estimator says to know it since its start, where position and yaw
/// are exact.
struct PoseCovarianceSample {
  Timestamp t;
  SE3 T_W_B;
  Eigen::Matrix3d position;  ///< covariance in W [m^2]
  Eigen::Matrix3d rotation;  ///< covariance in B of phi in R_true = R Exp(phi) [rad^2]
  bool good = true;          ///< the status was Good
  int start = 0;             ///< another number after each new start
};

/// A normal error of three dimensions has a mean of 3 and shares of 99.73 %. No share where there are no poses.
struct NormalizedErrors {
  double mean_nees = 0.0;  ///< e' P^-1 e
  double max_nees = 0.0;
  double within = 1.0;                                    ///< share of the poses whose NEES is that of 99.73 % or less
  Eigen::Vector3d axes_within = Eigen::Vector3d::Ones();  ///< share within three sigmas on each axis
};

struct TimeSpan {
  Timestamp begin, end;
};

/// One position error, estimate less truth, laid on as below, and how large it may be.
struct PoseErrorSample {
  Timestamp t;
  Eigen::Vector3d error, sigma;  ///< in the true W [m]
};

struct Consistency {
  std::size_t poses = 0, starts = 0;
  NormalizedErrors position, rotation;
  /// Where the estimate had diverged silently: all of the poses for more than 0.5 s are Good, but with the position or
  /// the rotation beyond the 99.73 %.
  std::vector<TimeSpan> silent;
  std::vector<PoseErrorSample> errors;  ///< of each pose

  double silent_s() const;
};

/// Compares what is claimed with the truth: the same body on the same clock, both in time order. The first Good pose of
/// each start is laid onto the truth, position and yaw; what comes before it is left out. As that pose is not exact
/// either (after a start in motion it is centimetres off), its covariance counts with each error. Errors below 0.1 mm
/// and 0.1 mrad are never too large.
Consistency check_consistency(const Trajectory& truth, const std::vector<PoseCovarianceSample>& samples);

}  // namespace edged

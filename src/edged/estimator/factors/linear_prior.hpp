// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A Gaussian prior over any blocks, in square-root form at a fixed linearisation point: the result of marginalization,
// and every initial prior (gauge, biases, zero velocity).
#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "edged/estimator/factors/factor.hpp"

namespace edged {

/// residual(x) = J * (x - x0) + r, with the difference in the tangent space, blocks stacked in order.
struct LinearPrior {
  std::vector<BlockKey> blocks;
  std::vector<std::vector<double>> x0;  ///< one linearisation point per block
  Eigen::MatrixXd J;                    ///< rows x sum of tangent sizes
  Eigen::VectorXd r;
  Eigen::MatrixXd information = {};  ///< J^T J, of the prior of marginalization; else empty

  bool empty() const { return blocks.empty(); }
};

/// A block near these values, with one sigma for each of its numbers. Zero fixes a number, kFree leaves it free.
LinearPrior prior_at(BlockKey key, std::span<const double> values, const Eigen::VectorXd& sigmas);

/// Fixes position and yaw (rotation about z) of one pose at their present value.
LinearPrior gauge_prior(BlockKey pose, const PoseBlock& at, double position_sigma, double yaw_sigma);

/// The sigma of what a prior leaves free.
inline constexpr double kFree = std::numeric_limits<double>::infinity();

/// A motion block near `mean`; sigmas for velocity [m/s], gyro bias [rad/s], accelerometer bias [m/s^2]. An infinite
/// sigma leaves that part free.
LinearPrior motion_prior(BlockKey motion, const MotionBlock& mean, const Eigen::Vector3d& sigmas);

/// The accelerometer reading at rest: bias plus the reaction to gravity in B, linearised at the given state, whose tilt
/// follows from that reading and whose bias is zero. It couples tilt and bias much more tightly than either is known.
/// sigma [m/s^2].
LinearPrior rest_prior(BlockKey pose, const PoseBlock& at, BlockKey motion, const MotionBlock& mean,
                       const Eigen::Vector3d& accel_B, double sigma);

/// It ends when one of its states is dropped.
class LinearPriorFactor final : public Factor {
 public:
  explicit LinearPriorFactor(LinearPrior prior);
  const LinearPrior& prior() const { return prior_; }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  LinearPrior prior_;
};

}  // namespace edged

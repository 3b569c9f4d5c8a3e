// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A Gaussian prior over any blocks, held in square-root form at a fixed linearisation point: what marginalisation
// leaves behind, and every hand-set prior (gauge, biases, zero velocity).
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "edged/estimator/factors/factor.hpp"

namespace edged {

/// residual(x) = J * (x - x0) + r, with the difference in the tangent space, blocks stacked in order.
struct LinearPrior {
  std::vector<BlockKey> blocks;
  std::vector<std::vector<double>> x0;  ///< one linearisation point a block
  Eigen::MatrixXd J;                    ///< rows x sum of tangent sizes
  Eigen::VectorXd r;
  Eigen::MatrixXd information = {};  ///< J^T J, of what marginalisation leaves; else empty

  bool empty() const { return blocks.empty(); }
};

/// Position and yaw (rotation about the world's z) of one pose held at its present value.
LinearPrior gauge_prior(BlockKey pose, const PoseBlock& at, double position_sigma, double yaw_sigma);

/// The sigma of what a prior leaves open.
inline constexpr double kFree = std::numeric_limits<double>::infinity();

/// A motion block near `mean`; sigmas for velocity [m/s], gyro bias [rad/s], accelerometer bias [m/s^2]. An infinite
/// sigma leaves that part free.
LinearPrior motion_prior(BlockKey motion, const MotionBlock& mean, const Eigen::Vector3d& sigmas);

/// What an accelerometer at rest has read: bias plus gravity's reaction in B, linearised at the given state, which
/// stands upright by that reading and has no bias. It ties tilt and bias together far closer than either is known.
/// sigma [m/s^2].
LinearPrior rest_prior(BlockKey pose, const PoseBlock& at, BlockKey motion, const MotionBlock& mean,
                       const Eigen::Vector3d& accel_B, double sigma);

/// It ends with a state of it that is dropped.
class LinearPriorFactor final : public Factor {
 public:
  explicit LinearPriorFactor(LinearPrior prior);
  const LinearPrior& prior() const { return prior_; }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  LinearPrior prior_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The corners of one picture as terms of a cost: from the target alone, or through the motion of the body.
#pragma once

#include <ceres/cost_function.h>
#include <ceres/manifold.h>

#include <vector>

#include "edged/calibrate/target_view.hpp"

namespace edged {

/// A corner on the target and in the picture.
struct CornerPair {
  Eigen::Vector3d p_T;
  Eigen::Vector2d pixel;
};
std::vector<CornerPair> pairs_of(const TargetView& view, const TargetLayout& layout);

/// Cauchy's loss with this scale, in standard deviations of a corner.
inline constexpr double kRobustAt = 3.0;

/// r times the root of rho(r^2) / r^2, so that its square is Cauchy's loss, and the factor's derivative: J of the
/// result is factor J + slope r r^T J.
struct Robust {
  double factor, slope;
};
Robust robust(double squared);

/// The tangent space of PoseBlock (estimator/factors/blocks.hpp): the first six of the seven columns that a cost
/// function writes.
class PoseBlockManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

/// Blocks: T_C_T (PoseBlock), lens (LensParameters). Residuals: two a corner, over sigma_px, robust.
class PlainReprojection final : public ceres::CostFunction {
 public:
  PlainReprojection(std::vector<CornerPair> corners, DistortionModel distortion, double sigma_px);
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  std::vector<CornerPair> corners_;
  DistortionModel distortion_;
  double sigma_px_;
};

/// Blocks: T_W_B at the time of the state (PoseBlock), motion (v, gyro bias, accelerometer bias), T_B_C (PoseBlock),
/// correction of the clock [s], tilt of the target (2): R_W_T = Exp(tilt, 0) R_W_T,given, lens. The pose at the time of
/// the picture follows from the one of the state, its velocity and its rate of turn.
class MovingReprojection final : public ceres::CostFunction {
 public:
  struct Instant {
    double after_state_s = 0.0;  ///< the picture, by the given clock
    Eigen::Vector3d gyro_B = Eigen::Vector3d::Zero();
    Eigen::Quaterniond R_W_T = Eigen::Quaterniond::Identity();
  };
  MovingReprojection(std::vector<CornerPair> corners, DistortionModel distortion, double sigma_px,
                     const Instant& instant);
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override;

 private:
  std::vector<CornerPair> corners_;
  DistortionModel distortion_;
  double sigma_px_;
  Instant instant_;
};

}  // namespace edged

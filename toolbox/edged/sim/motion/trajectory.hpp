// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Motion in continuous time: a quintic B-spline through pose samples, with a rest at its beginning.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "edged/state.hpp"

namespace edged {

/// Pose and motion of the body at one instant; all derivatives are exact.
struct Kinematics {
  SE3 T_W_B;
  Eigen::Vector3d v_W = Eigen::Vector3d::Zero();      ///< velocity of B [m/s]
  Eigen::Vector3d a_W = Eigen::Vector3d::Zero();      ///< acceleration of B [m/s^2]
  Eigen::Vector3d omega_B = Eigen::Vector3d::Zero();  ///< angular velocity [rad/s]
};

/// Parameters of the spline fit.
struct SplineFit {
  /// Spacing of the control points [s]: motion faster than about 0.5 / knot_s [Hz] is smoothed away.
  double knot_s = 0.05;
  int reweightings = 5;  ///< rounds of Cauchy weights; 0 is plain least squares
};

/// Uniform quintic B-spline over (x, y, z, qx, qy, qz, qw); the rotation is the quaternion normalised. Four times
/// continuously differentiable in both, and its fit is linear.
class PoseSpline {
 public:
  using Vector7d = Eigen::Matrix<double, 7, 1>;

  /// Robust least squares fit of samples T_W_B in time order. Outliers get a low weight, and gaps are bridged smoothly.
  /// Throws InputError for fewer than 8 samples, and for stamps that do not increase.
  static PoseSpline fit(const Trajectory& samples, const SplineFit& options);

  /// Seconds since the first sample; clamped to [0, duration].
  Kinematics at(double s) const;
  double duration() const { return duration_; }

 private:
  double knot_s_ = 0.0, duration_ = 0.0;
  std::vector<Vector7d> control_;
};

/// From 0 to 1 while t goes from 0 to its length, with two derivatives zero at both ends: 10 x^3 - 15 x^4 + 6 x^5.
struct Ramp {
  double value, slope, integral_s;  ///< slope [1/s]; the integral is that from 0 to t
};
Ramp ramp(double t, double length_s);

/// A spline that is at rest at first and then starts smoothly. The path is unchanged: its clock s(t) accelerates from
/// rest to full speed during the blend.
class ContinuousTrajectory {
 public:
  /// rest_s: time at rest [s]; blend_s: until full speed is reached [s].
  ContinuousTrajectory(PoseSpline spline, double rest_s, double blend_s)
      : spline_(std::move(spline)), rest_s_(rest_s), blend_s_(blend_s) {}

  /// t: seconds since the start of the rest. Before 0 and after duration() the body stands still.
  Kinematics at(double t) const;
  double duration() const { return rest_s_ + 0.5 * blend_s_ + spline_.duration(); }

 private:
  PoseSpline spline_;
  double rest_s_, blend_s_;
};

}  // namespace edged

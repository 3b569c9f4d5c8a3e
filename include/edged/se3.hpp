// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// SO(3) and SE(3): exp, log, right Jacobian. Right perturbation everywhere: R' = R * Exp(phi).
// A tangent of SE(3) is (rho, phi): translation first, then rotation. Formulas: Sola, Deray, Atchuthan,
// "A micro Lie theory for state estimation in robotics" (2018), numbers in the comments are its equations.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace edged {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// The skew matrix of v: skew(v) * u = v x u.
Eigen::Matrix3d skew(const Eigen::Vector3d& v);

namespace so3 {
/// Unit quaternion of a rotation vector [rad].
Eigen::Quaterniond exp(const Eigen::Vector3d& phi);
/// Rotation vector [rad] of norm at most pi.
Eigen::Vector3d log(const Eigen::Quaterniond& q);
/// Right Jacobian (Eq. 143): Exp(phi + d) ~ Exp(phi) * Exp(J_r(phi) d).
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& phi);
/// Inverse of the right Jacobian (Eq. 144).
Eigen::Matrix3d right_jacobian_inverse(const Eigen::Vector3d& phi);
}  // namespace so3

/// A rigid transform. T_A_B maps points of frame B to frame A: p_A = T_A_B * p_B, so T_A_C = T_A_B * T_B_C.
class SE3 {
 public:
  SE3() = default;
  /// q is normalised; it must not be zero.
  SE3(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) : q_(q.normalized()), p_(p) {}
  /// R must be a rotation matrix (orthonormal, determinant 1) to within rounding.
  SE3(const Eigen::Matrix3d& R, const Eigen::Vector3d& p) : q_(Eigen::Quaterniond(R).normalized()), p_(p) {}

  const Eigen::Quaterniond& rotation() const { return q_; }
  const Eigen::Vector3d& translation() const { return p_; }
  Eigen::Quaterniond& rotation() { return q_; }
  Eigen::Vector3d& translation() { return p_; }
  Eigen::Matrix3d R() const { return q_.toRotationMatrix(); }
  Eigen::Matrix4d matrix() const;

  SE3 inverse() const;
  SE3 operator*(const SE3& other) const;
  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const { return q_ * point + p_; }

  /// Exp of the twist (rho, phi) (Eq. 172) and its inverse (Eq. 173).
  static SE3 exp(const Vector6d& xi);
  Vector6d log() const;

 private:
  Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d p_ = Eigen::Vector3d::Zero();
};

/// The pose at share a of the constant-twist motion from T_0 (a = 0) to T_1 (a = 1), paper Eq. 1 in its corrected form:
/// T_0 * Exp(a * Log(T_0^-1 * T_1)). a may lie outside [0, 1].
SE3 interpolate(const SE3& T_0, const SE3& T_1, double a);

}  // namespace edged

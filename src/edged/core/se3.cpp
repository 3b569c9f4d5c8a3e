// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/se3.hpp"

#include <cmath>

namespace edged {
namespace {

// Below this angle [rad] the closed forms lose digits and their series are used instead.
constexpr double kSmallAngle = 1e-4;

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

namespace so3 {

Eigen::Quaterniond exp(const Eigen::Vector3d& phi) {
  const double theta2 = phi.squaredNorm();
  const double theta = std::sqrt(theta2);
  const double half_sinc = theta < kSmallAngle ? 0.5 - theta2 / 48.0 : std::sin(0.5 * theta) / theta;
  Eigen::Quaterniond q;
  q.w() = std::cos(0.5 * theta);
  q.vec() = half_sinc * phi;
  return q.normalized();
}

Eigen::Vector3d log(const Eigen::Quaterniond& q_in) {
  const double sign = q_in.w() < 0 ? -1.0 : 1.0;  // q and -q are the same rotation: the shorter one
  const Eigen::Vector3d v = sign * q_in.vec();
  const double w = sign * q_in.w();
  const double n = v.norm();
  if (n < kSmallAngle) return 2.0 / w * (1.0 - n * n / (3.0 * w * w)) * v;
  return 2.0 * std::atan2(n, w) / n * v;
}

Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& phi) {
  const double theta2 = phi.squaredNorm();
  const double theta = std::sqrt(theta2);
  const Eigen::Matrix3d F = skew(phi);
  if (theta < kSmallAngle) return Eigen::Matrix3d::Identity() - 0.5 * F + F * F / 6.0;
  const double half_sine = std::sin(0.5 * theta);
  return Eigen::Matrix3d::Identity() - 2.0 * half_sine * half_sine / theta2 * F +
         (theta - std::sin(theta)) / (theta2 * theta) * F * F;
}

Eigen::Matrix3d right_jacobian_inverse(const Eigen::Vector3d& phi) {
  const double theta2 = phi.squaredNorm();
  const double theta = std::sqrt(theta2);
  const Eigen::Matrix3d F = skew(phi);
  if (theta < kSmallAngle) return Eigen::Matrix3d::Identity() + 0.5 * F + F * F / 12.0;
  const double c = 1.0 / theta2 - (1.0 + std::cos(theta)) / (2.0 * theta * std::sin(theta));
  return Eigen::Matrix3d::Identity() + 0.5 * F + c * F * F;
}

}  // namespace so3

Eigen::Matrix4d SE3::matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = R();
  m.topRightCorner<3, 1>() = p_;
  return m;
}

SE3 SE3::inverse() const {
  const Eigen::Quaterniond q_inv = q_.conjugate();
  return {q_inv, -(q_inv * p_)};
}

SE3 SE3::operator*(const SE3& other) const { return {q_ * other.q_, q_ * other.p_ + p_}; }

SE3 SE3::exp(const Vector6d& xi) {
  const Eigen::Vector3d phi = xi.tail<3>();
  return {so3::exp(phi), so3::right_jacobian(-phi) * xi.head<3>()};  // J_l(phi) = J_r(-phi)
}

Vector6d SE3::log() const {
  Vector6d xi;
  const Eigen::Vector3d phi = so3::log(q_);
  xi << so3::right_jacobian_inverse(-phi) * p_, phi;
  return xi;
}

SE3 interpolate(const SE3& T_0, const SE3& T_1, double a) { return T_0 * SE3::exp(a * (T_0.inverse() * T_1).log()); }

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/se3.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace edged {
namespace {

constexpr double kStep = 1e-5;

/// Rotation vectors from below every series' threshold to just short of pi, in several directions.
std::vector<Eigen::Vector3d> rotation_vectors() {
  constexpr double kPi = std::numbers::pi;
  const std::vector<double> angles = {0.0, 1e-12, 1e-8, 9.9e-5, 1.01e-4, 9.9e-3,     1.01e-2,
                                      0.1, 0.5,   1.0,  2.0,    3.0,     kPi - 1e-3, kPi - 1e-7};
  std::vector<Eigen::Vector3d> all;
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(1, -2, 0.5),
        Eigen::Vector3d(-0.3, 0.7, 2)}) {
    for (const double angle : angles) all.push_back(angle * direction.normalized());
  }
  return all;
}

Vector6d twist(const Eigen::Vector3d& rho, const Eigen::Vector3d& phi) {
  Vector6d xi;
  xi << rho, phi;
  return xi;
}

void expect_same(const SE3& a, const SE3& b, double tolerance) {
  EXPECT_LT((a.matrix() - b.matrix()).cwiseAbs().maxCoeff(), tolerance);
}

const SE3 kPose(Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2), Eigen::Vector3d(1.5, -2.0, 0.25));

TEST(SO3, LogUndoesExpFromZeroToPi) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    EXPECT_LT((so3::log(so3::exp(phi)) - phi).norm(), 1e-12 + 1e-14 * phi.norm()) << phi.transpose();
  }
}

TEST(SO3, LogTakesTheShortWayForBothSignsOfTheQuaternion) {
  const Eigen::Vector3d phi(0.2, -0.4, 1.0);
  Eigen::Quaterniond q = so3::exp(phi);
  q.coeffs() *= -1.0;
  EXPECT_LT((so3::log(q) - phi).norm(), 1e-14);
  EXPECT_NEAR(so3::log(so3::exp(Eigen::Vector3d(0, 0, 1.5 * std::numbers::pi))).z(), -0.5 * std::numbers::pi, 1e-12);
}

TEST(SO3, LogOfAHalfTurnHasNormPi) {
  EXPECT_NEAR(so3::log(Eigen::Quaterniond(0, 0, 1, 0)).norm(), std::numbers::pi, 1e-15);
}

TEST(SO3, SkewIsTheCrossProduct) {
  const Eigen::Vector3d a(1, 2, 3), b(-4, 0.5, 2);
  EXPECT_LT((skew(a) * b - a.cross(b)).norm(), 1e-15);
}

TEST(SO3, RightJacobianAgreesWithNumericDifferences) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    Eigen::Matrix3d numeric;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = kStep * Eigen::Vector3d::Unit(i);
      const Eigen::Vector3d plus = so3::log(so3::exp(phi).conjugate() * so3::exp(phi + d));
      const Eigen::Vector3d minus = so3::log(so3::exp(phi).conjugate() * so3::exp(phi - d));
      numeric.col(i) = (plus - minus) / (2 * kStep);
    }
    EXPECT_LT((so3::right_jacobian(phi) - numeric).cwiseAbs().maxCoeff(), 1e-8) << phi.transpose();
  }
}

TEST(SO3, RightJacobianKeepsAllDigitsAboveTheSmallAngles) {
  const Eigen::Vector3d axis = Eigen::Vector3d(-0.3, 0.7, 2).normalized();
  for (const double angle : {1.01e-4, 1e-3}) {
    const Eigen::Matrix3d F = skew(angle * axis);
    const double theta2 = angle * angle;
    const Eigen::Matrix3d series =
        Eigen::Matrix3d::Identity() - (0.5 - theta2 / 24.0) * F + (1.0 / 6.0 - theta2 / 120.0) * F * F;
    EXPECT_LT((so3::right_jacobian(angle * axis) - series).cwiseAbs().maxCoeff(), 5e-15) << angle;
  }
}

TEST(SO3, RightJacobianInverseIsTheInverse) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    const Eigen::Matrix3d product = so3::right_jacobian(phi) * so3::right_jacobian_inverse(phi);
    EXPECT_LT((product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-8) << phi.transpose();
  }
}

TEST(SE3, InverseAndProductAreThoseOfMatrices) {
  const SE3 other(so3::exp({0.1, 0.2, -0.3}), Eigen::Vector3d(4, 5, 6));
  EXPECT_LT(((kPose * other).matrix() - kPose.matrix() * other.matrix()).norm(), 1e-14);
  expect_same(kPose * kPose.inverse(), SE3(), 1e-14);
  const Eigen::Vector3d p(0.5, -1, 2);
  EXPECT_LT((kPose * p - (kPose.R() * p + kPose.translation())).norm(), 1e-14);
}

TEST(SE3, LogUndoesExpFromZeroToPi) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    const Vector6d xi = twist({0.3, -1.2, 2.5}, phi);
    EXPECT_LT((SE3::exp(xi).log() - xi).norm(), 1e-8) << phi.transpose();
  }
}

TEST(SE3, ExpUndoesLog) { expect_same(SE3::exp(kPose.log()), kPose, 1e-13); }

TEST(Interpolate, MeetsBothEndsAndExtendsTheSameTwistOutside) {
  const Vector6d xi = twist({1.0, -0.5, 0.2}, {0.2, 0.6, -0.3});
  const SE3 T_1 = kPose * SE3::exp(xi);
  expect_same(interpolate(kPose, T_1, 0.0), kPose, 1e-14);
  expect_same(interpolate(kPose, T_1, 1.0), T_1, 1e-13);
  expect_same(interpolate(kPose, T_1, 0.25), kPose * SE3::exp(0.25 * xi), 1e-13);
  expect_same(interpolate(kPose, T_1, 1.5), kPose * SE3::exp(1.5 * xi), 1e-13);
  expect_same(interpolate(kPose, T_1, -0.5), kPose * SE3::exp(-0.5 * xi), 1e-13);
}

}  // namespace
}  // namespace edged

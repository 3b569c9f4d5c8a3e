// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Jacobians of the map's residuals against numeric ones.
#include "edged/map/map_errors.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace edged {
namespace {

const SE3 kT_M_B(so3::exp({0.2, -0.4, 0.7}), {0.5, -0.3, 1.1});
const SE3 kT_M_K(so3::exp({-0.1, 0.3, 0.6}), {0.2, 0.1, 0.9});
const SE3 kT_B_C(so3::exp({0.1, 0.05, -0.2}), {0.05, -0.02, 0.03});

/// Jacobian of a residual by the error of a pose, by central differences.
Eigen::MatrixXd numeric_by_pose(const std::function<Eigen::VectorXd(const SE3&)>& residual, const SE3& T) {
  constexpr double kStep = 1e-6;
  Eigen::MatrixXd J(residual(T).size(), 6);
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = kStep * Vector6d::Unit(i);
    J.col(i) = (residual(corrected(T, step)) - residual(corrected(T, -step))) / (2.0 * kStep);
  }
  return J;
}

TEST(MapErrors, JacobiansOfAnObservation) {
  MapObservation observation;
  observation.p_K = (kT_M_K.inverse() * kT_M_B * kT_B_C) * Eigen::Vector3d(0.4, -0.3, 2.5);
  observation.seen = {0.1, -0.1};
  observation.sigma = 0.01;
  const auto residual = [&](const SE3& T_M_B, const SE3& T_M_K) {
    return Eigen::VectorXd(linearised(observation, T_M_B, T_M_K, kT_B_C).value().r);
  };
  const LinearizedObservation row = linearised(observation, kT_M_B, kT_M_K, kT_B_C).value();
  EXPECT_LT((row.by_body - numeric_by_pose([&](const SE3& T) { return residual(T, kT_M_K); }, kT_M_B)).norm(), 1e-6);
  EXPECT_LT((row.by_keyframe - numeric_by_pose([&](const SE3& T) { return residual(kT_M_B, T); }, kT_M_K)).norm(),
            1e-6);
}

TEST(MapErrors, JacobianOfGravity) {
  const GravityObservation observation =
      observed_gravity(SE3(so3::exp({0.21, -0.38, 0.2}), Eigen::Vector3d::Zero()), 2.0);
  const auto residual = [&](const SE3& T) { return Eigen::VectorXd(T.R().row(2).transpose() - observation.up_B); };
  const Eigen::MatrixXd J = numeric_by_pose(residual, kT_M_B).rightCols<3>();
  const LinearizedGravity row = linearised(observation, kT_M_B);
  EXPECT_LT((row.H - observation.information * J.transpose() * J).norm(), 1e-6 * row.H.norm());
  EXPECT_LT((row.g - observation.information * J.transpose() * residual(kT_M_B)).norm(), 1e-6 * row.g.norm());
  EXPECT_LT((row.H * (kT_M_B.R().transpose() * Eigen::Vector3d::UnitZ())).norm(), 1e-9 * row.H.norm()) << "yaw is free";
}

TEST(MapErrors, GravityOfALongTimeCountsOnce) {
  EXPECT_NEAR(observed_gravity(SE3(), 0.5).information / observed_gravity(SE3(), 0.25).information, 2.0, 1e-9);
  EXPECT_EQ(observed_gravity(SE3(), 100.0).information, observed_gravity(SE3(), 1000.0).information);
  EXPECT_EQ(observed_gravity(SE3(), 0.0).information, 0.0);
}

}  // namespace
}  // namespace edged

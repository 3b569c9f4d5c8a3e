// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mapping/map_match_factor.hpp"

#include <gtest/gtest.h>

#include "edged/estimator/factors/test_jacobians.hpp"

namespace edged {
namespace {

const SE3 kT_O_A(so3::exp({0.1, -0.2, 0.3}), {0.2, -0.1, 0.3}),
    kT_A_B(so3::exp({0.02, 0.01, -0.03}), {0.05, 0.02, 0.01}), kT_O_K(so3::exp({-0.1, 0.1, 0.4}), {-0.3, 0.2, 0.1}),
    kT_B_C(so3::exp({0.01, 0.02, -0.01}), {0.02, 0.01, 0.03});
const Eigen::Vector3d kPoint_O(0.4, 0.3, 3.0);
const Eigen::Matrix2d kWhiten{{500.0, 20.0}, {20.0, 300.0}};

MapObservation observation(const Eigen::Vector2d& off = {0.0, 0.0}) {
  const Eigen::Vector3d p_C = (kT_O_A * kT_A_B * kT_B_C).inverse() * kPoint_O;
  return {0, kT_O_K.inverse() * kPoint_O, Eigen::Vector3d::Zero(), p_C.hnormalized() + off, 0.002};
}

TEST(MapMatchFactor, HasTheJacobiansOfItsResidual) {
  const MapMatchFactor between({1, kT_A_B, kT_B_C}, {0, SE3()}, observation({0.003, -0.002}), kWhiten, 0.5);
  check_jacobians(between, {pose_block(kT_O_A), pose_block(kT_O_K)});
  const MapMatchFactor known({1, kT_A_B, kT_B_C}, {std::nullopt, kT_O_K}, observation({0.003, -0.002}), kWhiten, 0.5);
  check_jacobians(known, {pose_block(kT_O_A)});
}

TEST(MapMatchFactor, IsZeroWhereThePointIsSeen) {
  const MapMatchFactor factor({1, kT_A_B, kT_B_C}, {0, SE3()}, observation(), kWhiten, 1.0);
  EXPECT_LT(evaluate(factor, {pose_block(kT_O_A), pose_block(kT_O_K)}).norm(), 1e-9);
}

TEST(MapMatchFactor, CountsForItsShareOfOneObservation) {
  const MapMatchFactor whole({1, kT_A_B, kT_B_C}, {0, SE3()}, observation(), kWhiten, 1.0);
  const MapMatchFactor share({1, kT_A_B, kT_B_C}, {0, SE3()}, observation(), kWhiten, 0.25);
  double of_whole[3], of_share[3];
  whole.loss()->Evaluate(2.0, of_whole);
  share.loss()->Evaluate(2.0, of_share);
  EXPECT_DOUBLE_EQ(of_share[0], 0.25 * of_whole[0]);
  EXPECT_DOUBLE_EQ(of_share[1], 0.25 * of_whole[1]) << "an outlier is one whatever its share";
}

TEST(MapMatchFactor, IsNotDefinedBehindTheCamera) {
  MapObservation behind = observation();
  behind.p_K = kT_O_K.inverse() * Eigen::Vector3d(0.0, 0.0, -3.0);
  const MapMatchFactor factor({1, kT_A_B, kT_B_C}, {0, SE3()}, behind, kWhiten, 1.0);
  const Blocks blocks = {pose_block(kT_O_A), pose_block(kT_O_K)};
  const double* values[] = {blocks[0].data(), blocks[1].data()};
  double residuals[2];
  EXPECT_FALSE(factor.Evaluate(values, residuals, nullptr));
}

}  // namespace
}  // namespace edged

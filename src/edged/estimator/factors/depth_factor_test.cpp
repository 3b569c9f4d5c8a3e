// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/depth_factor.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "edged/estimator/factors/test_jacobians.hpp"

namespace edged {
namespace {

constexpr BlockKey kScale{BlockKind::LogScale, 0};

/// Three landmarks of two cameras, anchored in the observing state and in two others.
struct DepthScene {
  SE3 T_B_E{so3::exp({0.02, -0.01, 1.5}), {0.05, -0.02, 0.03}}, T_B_F{so3::exp({-0.1, 0.05, 1.4}), {-0.04, 0.01, 0.0}};
  std::vector<DepthLandmark> landmarks = {
      {7, T_B_E, {0.2, -0.1}, 0}, {8, T_B_F, {-0.1, 0.15}, 1}, {9, T_B_E, {0.05, 0.0}, 2}};
  Blocks blocks = {{0.3},
                   pose_block({0.1, 0.2, -0.1}, {1, 0.5, 0.2}),
                   pose_block({0.15, 0.15, -0.05}, {1.1, 0.45, 0.22}),
                   pose_block({0.02, 0.25, -0.2}, {0.8, 0.6, 0.1}),
                   {0.5},
                   {0.02},
                   {2.0}};
};

TEST(DepthFactor, JacobiansMatchCentralDifferencesInBothForms) {
  const DepthScene scene;
  for (const DepthResidual form : {DepthResidual::Log, DepthResidual::Paper}) {
    const DepthFactor factor({form, 0, scene.T_B_E, 1.7, 2.5}, kScale, scene.landmarks);
    check_jacobians(factor, scene.blocks);
  }
}

TEST(DepthFactor, IsZeroWhereTheSourceTimesItsScaleIsTheMiddleOfTheLandmarks) {
  const DepthScene scene;
  const std::vector<DepthLandmark> own = {scene.landmarks[0]};
  const double s = 1.4, depth = 2.0;  // of the only landmark, in its own anchor view
  for (const DepthResidual form : {DepthResidual::Log, DepthResidual::Paper}) {
    const DepthFactor factor({form, 0, scene.T_B_E, s * depth, 3.0}, kScale, own);
    EXPECT_NEAR(evaluate(factor, {{std::log(s)}, scene.blocks[1], {1.0 / depth}})[0], 0.0, 1e-12);
  }
}

TEST(DepthFactor, GoesIntoThePriorWithItsStateOnlyIfItsLandmarksLeaveToo) {
  const DepthScene scene;
  const DepthMeasurement measured{DepthResidual::Log, 0, scene.T_B_E, 1.7, 2.5};
  const std::set<BlockKey> leaving = {{BlockKind::Pose, 0}, {BlockKind::Motion, 0}, kScale};
  EXPECT_TRUE(DepthFactor(measured, kScale, {scene.landmarks[0]}).marginalized_with(leaving));
  EXPECT_FALSE(DepthFactor(measured, kScale, scene.landmarks).marginalized_with(leaving));
  EXPECT_FALSE(DepthFactor(measured, kScale, {scene.landmarks[0]}).marginalized_with({kScale}));
}

TEST(DepthFactor, RefusesALandmarkBehindTheCamera) {
  const DepthFactor factor({DepthResidual::Log, 0, SE3(), 1.0, 1.0}, kScale, {{7, SE3(), {0.0, 0.0}, 1}});
  const double ln_s = 0.0, rho = 1.0;
  const auto turned = pose_block({0, 3.1, 0}, {0, 0, 0}), here = pose_block({0, 0, 0}, {0, 0, 0});
  const double* blocks[] = {&ln_s, turned.data(), here.data(), &rho};
  double r[1];
  EXPECT_FALSE(factor.Evaluate(blocks, r, nullptr));
}

}  // namespace
}  // namespace edged

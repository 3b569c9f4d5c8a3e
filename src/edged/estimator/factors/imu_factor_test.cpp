// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/factors/imu_factor.hpp"

#include <gtest/gtest.h>

#include "edged/estimator/factors/test_motion.hpp"

namespace edged {
namespace {

TEST(ImuFactor, JacobiansMatchCentralDifferences) {
  const TestMotion motion;
  const Preintegration imu = motion.between(0.0, 0.2);
  const ImuFactor factor(0, 1, imu);
  const std::vector<double> intrinsics = {3e-3, -2e-3, 1e-3,  2e-3, -4e-3, 1e-3,  0.5e-3, -1e-3, 2e-3,
                                          1e-3, 2e-3,  -3e-3, 1e-3, 5e-3,  -2e-3, 1e-3,   2e-3,  -1e-3};
  check_jacobians(factor, {pose_block({0.3, -0.8, 0.2}, {1, 2, 3}),
                           {0.4, -0.3, 0.2, 0.02, -0.01, 0.025, 0.12, 0.02, -0.05},
                           pose_block({0.45, -0.85, 0.25}, {1.1, 1.9, 3.05}),
                           {0.5, -0.2, 0.3, 0.021, -0.012, 0.026, 0.13, 0.03, -0.06},
                           intrinsics});
}

TEST(ImuFactor, IsZeroForTheMotionThatWasMeasured) {
  const TestMotion motion;
  const Preintegration imu = motion.between(0.0, 0.2);
  const OdomState &start = motion.at(0.0), &end = motion.at(0.2);
  const Eigen::VectorXd r =
      evaluate(ImuFactor(0, 1, imu), {pose_block(start.T_O_B), motion_numbers(start), pose_block(end.T_O_B),
                                      motion_numbers(end), std::vector<double>(18, 0.0)});
  EXPECT_LT(r.cwiseAbs().maxCoeff(), 1e-5);  // in standard deviations
}

}  // namespace
}  // namespace edged

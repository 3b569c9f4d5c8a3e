// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Corrections at keyframes, between them and beyond.
#include "edged/dense/refined_poses.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace edged {
namespace {

Timestamp at_ms(int ms) { return Timestamp(std::chrono::milliseconds(ms)); }
SE3 at_x(double x_m) { return {Eigen::Quaterniond::Identity(), {x_m, 0.0, 0.0}}; }

TEST(RefinedPoses, AreTheCausalOnesUntilAKeyframeIsRefined) {
  RefinedPoses poses;
  poses.add_keyframe({at_ms(0), at_x(0.0)});
  EXPECT_FALSE(poses.known_until());
  EXPECT_EQ(poses({at_ms(0), at_x(3.0)}).translation().x(), 3.0);
}

TEST(RefinedPoses, InterpolateTheErrorBetweenKeyframes) {
  RefinedPoses poses;
  for (const int i : {0, 1, 2}) poses.add_keyframe({at_ms(100 * i), at_x(i)});
  poses.refine({at_ms(0), at_x(0.0)});
  poses.refine({at_ms(50), at_x(9.0)});  // no keyframe
  poses.refine({at_ms(100), at_x(1.2)});
  EXPECT_EQ(poses.known_until(), at_ms(100));
  EXPECT_NEAR(poses({at_ms(100), at_x(1.0)}).translation().x(), 1.2, 1e-12);
  EXPECT_NEAR(poses({at_ms(50), at_x(0.5)}).translation().x(), 0.6, 1e-12);
  EXPECT_NEAR(poses({at_ms(150), at_x(1.5)}).translation().x(), 1.7, 1e-12) << "beyond: as at the nearest";
  EXPECT_NEAR(poses({at_ms(-50), at_x(-0.5)}).translation().x(), -0.5, 1e-12);
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/mapping/loop_closer.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

/// A body that is tilted itself.
const SE3 kBody(so3::exp({0.3, -0.2, 1.0}), {4.0, 3.0, 1.0});

SE3 turned_in_map(const Eigen::Vector3d& phi) { return {so3::exp(phi) * kBody.rotation(), kBody.translation()}; }

TEST(DriftExplains, AHeadingThatIsOffAndAPositionWithinTheBound) {
  EXPECT_TRUE(drift_explains(kBody, kBody, 2.0));
  EXPECT_TRUE(drift_explains(kBody, turned_in_map({0.0, 0.0, 0.14}), 2.0));
  EXPECT_FALSE(drift_explains(kBody, turned_in_map({0.0, 0.0, 0.2}), 2.0));
  EXPECT_TRUE(drift_explains(kBody, turned_in_map({0.0, 0.0, 0.2}), 10.0));
  const SE3 away(kBody.rotation(), kBody.translation() + Eigen::Vector3d(1.5, 0.0, 0.0));
  EXPECT_TRUE(drift_explains(kBody, away, 2.0));
  EXPECT_FALSE(drift_explains(kBody, away, 1.0));
}

TEST(DriftExplains, NoChangeOfRollAndPitch) {
  EXPECT_TRUE(drift_explains(kBody, turned_in_map({0.08, 0.0, 0.0}), 20.0));
  EXPECT_FALSE(drift_explains(kBody, turned_in_map({0.12, 0.0, 0.0}), 20.0));
  EXPECT_FALSE(drift_explains(kBody, turned_in_map({0.0, 0.2, 0.2}), 20.0));
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/scale_uncertainty.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void move(ScaleUncertainty& scale, double from_s, double to_s, const Vector3d& velocity, const Matrix3d& covariance) {
  for (double t = from_s; t < to_s; t += 0.1) scale.add(timestamp_from_seconds(t), velocity, covariance);
}

Matrix3d variance(double x, double y, double z) { return Vector3d(x, y, z).asDiagonal(); }

TEST(ScaleUncertainty, IsThatOfTheSpeedAlongTheMotion) {
  ScaleUncertainty scale;
  move(scale, 0.0, 2.0, {0.5, 0.0, 0.0}, variance(0.01 * 0.01, 1.0, 1.0));
  ASSERT_TRUE(scale.sigma());
  EXPECT_NEAR(*scale.sigma(), 0.02, 1e-9);
}

TEST(ScaleUncertainty, IsNothingBeforeTheBodyHasTravelled) {
  ScaleUncertainty scale;
  EXPECT_FALSE(scale.sigma());
  move(scale, 0.0, 3.0, {0.04, 0.0, 0.0}, variance(1.0, 1.0, 1.0));
  EXPECT_FALSE(scale.sigma());
  move(scale, 3.0, 5.0, {0.04, 0.0, 0.0}, variance(1.0, 1.0, 1.0));
  EXPECT_TRUE(scale.sigma());
}

TEST(ScaleUncertainty, IsOfTheLastMotionOnly) {
  ScaleUncertainty last(5.0), whole;
  for (ScaleUncertainty* scale : {&last, &whole}) {
    move(*scale, 0.0, 10.0, {1.0, 0.0, 0.0}, variance(0.25, 0.0, 0.0));
    move(*scale, 10.0, 40.0, {1.0, 0.0, 0.0}, variance(1e-4, 0.0, 0.0));
  }
  EXPECT_LT(*last.sigma(), 0.02);
  EXPECT_NEAR(*whole.sigma(), 0.25 * 0.5 + 0.75 * 0.01, 0.01);
}

TEST(ScaleUncertainty, ForgetsTheWayDuringALongRest) {
  ScaleUncertainty scale(5.0);
  move(scale, 0.0, 2.0, {0.2, 0.0, 0.0}, variance(1e-4, 0.0, 0.0));
  EXPECT_TRUE(scale.sigma());
  move(scale, 2.0, 60.0, {1e-4, 0.0, 0.0}, variance(1e-6, 1e-6, 1e-6));
  EXPECT_FALSE(scale.sigma());
}

TEST(ScaleUncertainty, TakesALossForNoMotion) {
  ScaleUncertainty scale;
  scale.add(timestamp_from_seconds(0.0), {0.4, 0.0, 0.0}, variance(0.01, 0.0, 0.0));
  scale.add(timestamp_from_seconds(60.0), {0.4, 0.0, 0.0}, variance(0.01, 0.0, 0.0));
  EXPECT_FALSE(scale.sigma());
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/place_uncertainty.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

constexpr double kEnough_m = 0.15;

/// Two samples so many seconds apart.
Preintegration motion(double length_s, bool gap) {
  const std::vector<ImuSample> imu = {{timestamp_from_seconds(0.0), {0, 0, 0}, {0, 0, 9.81}, gap},
                                      {timestamp_from_seconds(length_s), {0, 0, 0}, {0, 0, 9.81}, gap}};
  return {imu, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), {}};
}

TEST(PlaceUncertainty, IgnoresDriftWithoutAGap) {
  PlaceUncertainty place;
  for (const double sigma : {0.01, 0.2, 0.5}) place.update(sigma, kEnough_m);
  EXPECT_EQ(place.doubt(), 0.0);
}

TEST(PlaceUncertainty, HoldsWhatAGapAddsUntilTheCamerasOrTheMapTell) {
  PlaceUncertainty place;
  place.update(0.1, kEnough_m);
  place.end_gap();
  place.update(0.6, kEnough_m);
  EXPECT_NEAR(place.doubt(), 0.5, 1e-12);
  PlaceUncertainty relocalized = place;
  relocalized.relocalize();
  EXPECT_EQ(relocalized.doubt(), 0.0);
  place.update(0.12, kEnough_m);
  EXPECT_EQ(place.doubt(), 0.0);
  place.update(0.6, kEnough_m);
  EXPECT_EQ(place.doubt(), 0.0) << "later drift is none of it";
}

TEST(PlaceUncertainty, GrowsWithDeadReckoningAfterALossAndStaysUntilRelocalized) {
  PlaceUncertainty place;
  place.update(0.03, kEnough_m);
  place.end_estimate({.velocity = 0.2, .yaw = 0.01});
  EXPECT_NEAR(place.position(), 0.03, 1e-12);
  EXPECT_NEAR(place.yaw(), 0.01, 1e-12);
  place.dead_reckon(motion(0.02, false));
  EXPECT_NEAR(place.position(), 0.034, 1e-3);
  place.dead_reckon(motion(2.0, true));
  EXPECT_GT(place.position(), 2.5) << "2.2 sqrt(2^3 / 3) of the gap";
  EXPECT_GT(place.yaw(), 0.7);
  const double sigma = place.position();
  place.update(0.01, kEnough_m);
  EXPECT_EQ(place.position(), sigma);
  EXPECT_EQ(place.doubt(), sigma) << "dead reckoning is no map";
  place.relocalize();
  EXPECT_EQ(place.position(), 0.0);
}

TEST(PlaceUncertainty, IsNoneBeforeTheFirstStart) {
  PlaceUncertainty place;
  for (int i = 0; i < 200; ++i) place.dead_reckon(motion(0.1, true));
  EXPECT_EQ(place.position(), 0.0);
  EXPECT_EQ(place.yaw(), 0.0);
}

TEST(PlaceUncertainty, TakesAShareOfGravityForAcceleration) {
  PlaceUncertainty place;
  place.end_estimate({.tilt = 0.01});
  for (int i = 0; i < 200; ++i) place.dead_reckon(motion(0.01, false));
  EXPECT_NEAR(place.position(), 0.5 * 0.01 * kGravity * 4.0, 0.03);
}

TEST(PlaceUncertainty, DoubtsAPlaceThatOnlyTheImuTells) {
  PlaceUncertainty place;
  place.end_estimate({.velocity = 0.5});
  for (int i = 0; i < 100; ++i) place.dead_reckon(motion(0.01, false));
  EXPECT_NEAR(place.doubt(), 0.5, 0.01);
  EXPECT_EQ(place.doubt(), place.position());
}

}  // namespace
}  // namespace edged

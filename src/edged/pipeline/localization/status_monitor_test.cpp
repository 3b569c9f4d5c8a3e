// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/status_monitor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace edged {
namespace {

Timestamp at(double s) { return timestamp_from_seconds(s); }

EstimatorResult healthy() {
  EstimatorResult result;
  result.landmarks_seen = 50;
  result.imu_strain = 0.1;
  return result;
}

TEST(StatusMonitor, IsInitializingUntilTheFirstStartAndLostUntilALaterOne) {
  StatusMonitor monitor({});
  EXPECT_EQ(monitor.update({}, {}, false, at(0)), TrackingStatus::Initializing);
  EXPECT_EQ(monitor.update(healthy(), {}, true, at(1)), TrackingStatus::Good);
  EXPECT_EQ(monitor.update({}, {}, false, at(2)), TrackingStatus::Lost);
}

TEST(StatusMonitor, FallsToDegradedAndLostWithTheTimeWithoutLandmarks) {
  StatusMonitor monitor({});
  EstimatorResult blind = healthy();
  blind.landmarks_seen = 2;
  EXPECT_EQ(monitor.update(healthy(), {}, true, at(0.0)), TrackingStatus::Good);
  EXPECT_EQ(monitor.update(blind, {}, true, at(0.6)), TrackingStatus::Good);
  EXPECT_EQ(monitor.update(blind, {}, true, at(0.8)), TrackingStatus::Degraded);
  EXPECT_EQ(monitor.update(blind, {}, true, at(2.6)), TrackingStatus::Lost);
  EXPECT_THAT(monitor.reason(), testing::HasSubstr("2.6 s"));
  EXPECT_TRUE(monitor.vision_lost());
}

TEST(StatusMonitor, StaysDegradedWithoutLandmarksWhileAVelocitySensorHoldsIt) {
  StatusMonitor monitor({});
  EstimatorResult held = healthy(), blind = healthy();
  held.landmarks_seen = blind.landmarks_seen = 0;
  held.velocity_observed = true;
  EXPECT_EQ(monitor.update(healthy(), {}, true, at(0.0)), TrackingStatus::Good);
  for (double t = 1.0; t < 20.0; t += 0.5) EXPECT_EQ(monitor.update(held, {}, true, at(t)), TrackingStatus::Degraded);
  EXPECT_EQ(monitor.update(blind, {}, true, at(21.0)), TrackingStatus::Degraded) << "for as long as without the sensor";
  EXPECT_EQ(monitor.update(blind, {}, true, at(22.5)), TrackingStatus::Lost);
  EXPECT_TRUE(monitor.vision_lost());
}

TEST(StatusMonitor, IsGoodAtRestWithoutAnyLandmark) {
  StatusMonitor monitor({});
  EstimatorResult rest;
  rest.standstill = true;
  for (double t = 0.0; t < 10.0; t += 0.1) EXPECT_EQ(monitor.update(rest, {}, true, at(t)), TrackingStatus::Good);
}

TEST(StatusMonitor, DoubtsAWindowThatStrainsTheImu) {
  StatusMonitor monitor({});
  EstimatorResult strained = healthy();
  strained.imu_strain = 0.8;
  EXPECT_EQ(monitor.update(strained, {}, true, at(0.0)), TrackingStatus::Degraded);
  strained.imu_strain = 1.0;
  EXPECT_EQ(monitor.update(strained, {}, true, at(0.1)), TrackingStatus::Lost);
  EXPECT_THAT(monitor.reason(), testing::HasSubstr("contradict"));
  EXPECT_FALSE(monitor.vision_lost()) << "the pose is not reliable";
}

TEST(StatusMonitor, DoubtsAScaleThatTheMotionDoesNotTell) {
  StatusMonitor monitor({});
  EXPECT_EQ(monitor.update(healthy(), {.scale_sigma = 0.1}, true, at(0.0)), TrackingStatus::Good);
  EXPECT_EQ(monitor.update(healthy(), {.scale_sigma = 0.3}, true, at(0.1)), TrackingStatus::Degraded);
  EXPECT_THAT(monitor.reason(), testing::HasSubstr("scale known to 30 %"));
  EXPECT_EQ(monitor.update(healthy(), {}, true, at(0.2)), TrackingStatus::Good);
  EXPECT_EQ(monitor.reason(), "");
}

TEST(StatusMonitor, DoubtsAVelocityThatIsNotKnown) {
  StatusMonitor monitor({});
  EXPECT_EQ(monitor.update(healthy(), {.velocity_sigma = 0.25}, true, at(0.0)), TrackingStatus::Good);
  EXPECT_EQ(monitor.update(healthy(), {.velocity_sigma = 0.5}, true, at(0.1)), TrackingStatus::Degraded);
  EXPECT_THAT(monitor.reason(), testing::HasSubstr("velocity known to 0.50 m/s"));
}

TEST(StatusMonitor, IsLostWhereTheVelocityStaysUnknownForHalfASecond) {
  StatusMonitor monitor({});
  EXPECT_EQ(monitor.update(healthy(), {}, true, at(0.0)), TrackingStatus::Good);
  EXPECT_EQ(monitor.update(healthy(), {.velocity_sigma = 2.0}, true, at(0.4)), TrackingStatus::Degraded);
  EXPECT_EQ(monitor.update(healthy(), {.velocity_sigma = 1.0}, true, at(0.5)), TrackingStatus::Degraded);
  EXPECT_EQ(monitor.update(healthy(), {.velocity_sigma = 2.0}, true, at(1.0)), TrackingStatus::Degraded);
  EXPECT_EQ(monitor.update(healthy(), {.velocity_sigma = 2.0}, true, at(1.1)), TrackingStatus::Lost);
  EXPECT_THAT(monitor.reason(), testing::HasSubstr("velocity known to 2.0 m/s"));
  EXPECT_FALSE(monitor.contradicted());
  EXPECT_FALSE(monitor.vision_lost()) << "dead reckoning would go on with that velocity";
}

TEST(StatusMonitor, DoubtsAPlaceThatIsNotKnown) {
  StatusMonitor monitor({});
  EXPECT_EQ(monitor.update(healthy(), {.place_sigma = 0.1}, true, at(0.0)), TrackingStatus::Good);
  EXPECT_EQ(monitor.update(healthy(), {.place_sigma = 0.2}, true, at(0.1)), TrackingStatus::Degraded);
  EXPECT_THAT(monitor.reason(), testing::HasSubstr("position known to 0.20 m"));
}

TEST(StatusMonitor, BearsMoreStrainAfterALossByIt) {
  StatusMonitor monitor({});
  EstimatorResult strained = healthy();
  strained.imu_strain = 1.0;
  EXPECT_EQ(monitor.update(strained, {}, true, at(0.0)), TrackingStatus::Lost);
  monitor.update({}, {}, false, at(1.0));
  EXPECT_EQ(monitor.update(strained, {}, true, at(2.0)), TrackingStatus::Good);
  strained.imu_strain = 1.2;
  EXPECT_EQ(monitor.update(strained, {}, true, at(2.1)), TrackingStatus::Degraded);
  strained.imu_strain = 1.3;
  EXPECT_EQ(monitor.update(strained, {}, true, at(2.2)), TrackingStatus::Lost);
}

TEST(StatusMonitor, ForgetsThePastWhenItStartsAnew) {
  StatusMonitor monitor({});
  EstimatorResult blind = healthy();
  blind.landmarks_seen = 0;
  monitor.update(healthy(), {}, true, at(0.0));
  monitor.update({}, {}, false, at(1.0));
  EXPECT_EQ(monitor.update(blind, {}, true, at(5.0)), TrackingStatus::Good);
}

TEST(StatusMonitor, EndsAnEstimateWhoseImuBiasesChangeFasterThanTheyDrift) {
  StatusMonitor monitor({});
  EXPECT_EQ(monitor.update(healthy(), {.bias_change = 2.9}, true, at(0.0)), TrackingStatus::Good);
  EXPECT_FALSE(monitor.contradicted());
  EXPECT_EQ(monitor.update(healthy(), {.bias_change = 3.1}, true, at(0.1)), TrackingStatus::Lost);
  EXPECT_TRUE(monitor.contradicted());
  EXPECT_FALSE(monitor.vision_lost()) << "the pose is not reliable";
  EXPECT_THAT(monitor.reason(), testing::HasSubstr("biases would have changed (3.1 of 3.0 sigma"));
  EXPECT_EQ(monitor.update({}, {}, false, at(0.2)), TrackingStatus::Lost);
  EXPECT_TRUE(monitor.contradicted()) << "until it has started again";
  EXPECT_EQ(monitor.update(healthy(), {}, true, at(0.3)), TrackingStatus::Good);
  EXPECT_FALSE(monitor.contradicted());
}

}  // namespace
}  // namespace edged

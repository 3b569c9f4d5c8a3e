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

TEST(StatusJudge, IsInitializingUntilTheFirstStartAndLostUntilALaterOne) {
  StatusJudge judge({});
  EXPECT_EQ(judge.judge({}, 0.0, false, at(0)), TrackingStatus::Initializing);
  EXPECT_EQ(judge.judge(healthy(), 0.0, true, at(1)), TrackingStatus::Good);
  EXPECT_EQ(judge.judge({}, 0.0, false, at(2)), TrackingStatus::Lost);
}

TEST(StatusJudge, FallsToDegradedAndLostWithTheTimeWithoutLandmarks) {
  StatusJudge judge({});
  EstimatorResult blind = healthy();
  blind.landmarks_seen = 2;
  EXPECT_EQ(judge.judge(healthy(), 0.0, true, at(0.0)), TrackingStatus::Good);
  EXPECT_EQ(judge.judge(blind, 0.0, true, at(0.6)), TrackingStatus::Good);
  EXPECT_EQ(judge.judge(blind, 0.0, true, at(0.8)), TrackingStatus::Degraded);
  EXPECT_EQ(judge.judge(blind, 0.0, true, at(2.6)), TrackingStatus::Lost);
  EXPECT_THAT(judge.reason(), testing::HasSubstr("2.6 s"));
  EXPECT_TRUE(judge.vision_lost());
}

TEST(StatusJudge, StaysDegradedWithoutLandmarksWhileAVelocitySensorHoldsIt) {
  StatusJudge judge({});
  EstimatorResult held = healthy(), blind = healthy();
  held.landmarks_seen = blind.landmarks_seen = 0;
  held.velocity_observed = true;
  EXPECT_EQ(judge.judge(healthy(), 0.0, true, at(0.0)), TrackingStatus::Good);
  for (double t = 1.0; t < 20.0; t += 0.5) EXPECT_EQ(judge.judge(held, 0.0, true, at(t)), TrackingStatus::Degraded);
  EXPECT_EQ(judge.judge(blind, 0.0, true, at(21.0)), TrackingStatus::Degraded) << "for as long as without the sensor";
  EXPECT_EQ(judge.judge(blind, 0.0, true, at(22.5)), TrackingStatus::Lost);
  EXPECT_TRUE(judge.vision_lost());
}

TEST(StatusJudge, IsGoodAtRestWithoutAnyLandmark) {
  StatusJudge judge({});
  EstimatorResult rest;
  rest.standstill = true;
  for (double t = 0.0; t < 10.0; t += 0.1) EXPECT_EQ(judge.judge(rest, 0.0, true, at(t)), TrackingStatus::Good);
}

TEST(StatusJudge, DoubtsAWindowThatStrainsTheImu) {
  StatusJudge judge({});
  EstimatorResult strained = healthy();
  strained.imu_strain = 0.8;
  EXPECT_EQ(judge.judge(strained, 0.0, true, at(0.0)), TrackingStatus::Degraded);
  strained.imu_strain = 1.0;
  EXPECT_EQ(judge.judge(strained, 0.0, true, at(0.1)), TrackingStatus::Lost);
  EXPECT_THAT(judge.reason(), testing::HasSubstr("contradict"));
  EXPECT_FALSE(judge.vision_lost()) << "the pose is not reliable";
}

TEST(StatusJudge, BearsMoreStrainAfterALossByIt) {
  StatusJudge judge({});
  EstimatorResult strained = healthy();
  strained.imu_strain = 1.0;
  EXPECT_EQ(judge.judge(strained, 0.0, true, at(0.0)), TrackingStatus::Lost);
  judge.judge({}, 0.0, false, at(1.0));
  EXPECT_EQ(judge.judge(strained, 0.0, true, at(2.0)), TrackingStatus::Good);
  strained.imu_strain = 1.2;
  EXPECT_EQ(judge.judge(strained, 0.0, true, at(2.1)), TrackingStatus::Degraded);
  strained.imu_strain = 1.3;
  EXPECT_EQ(judge.judge(strained, 0.0, true, at(2.2)), TrackingStatus::Lost);
}

TEST(StatusJudge, ForgetsThePastWhenItStartsAnew) {
  StatusJudge judge({});
  EstimatorResult blind = healthy();
  blind.landmarks_seen = 0;
  judge.judge(healthy(), 0.0, true, at(0.0));
  judge.judge({}, 0.0, false, at(1.0));
  EXPECT_EQ(judge.judge(blind, 0.0, true, at(5.0)), TrackingStatus::Good);
}

TEST(StatusJudge, EndsAnEstimateWhoseImuBiasesChangeFasterThanTheyDrift) {
  StatusJudge judge({});
  EXPECT_EQ(judge.judge(healthy(), 2.9, true, at(0.0)), TrackingStatus::Good);
  EXPECT_FALSE(judge.contradicted());
  EXPECT_EQ(judge.judge(healthy(), 3.1, true, at(0.1)), TrackingStatus::Lost);
  EXPECT_TRUE(judge.contradicted());
  EXPECT_FALSE(judge.vision_lost()) << "the pose is not reliable";
  EXPECT_THAT(judge.reason(), testing::HasSubstr("biases would have changed (3.1 of 3.0 sigma"));
  EXPECT_EQ(judge.judge({}, 0.0, false, at(0.2)), TrackingStatus::Lost);
  EXPECT_TRUE(judge.contradicted()) << "until it has started again";
  EXPECT_EQ(judge.judge(healthy(), 0.0, true, at(0.3)), TrackingStatus::Good);
  EXPECT_FALSE(judge.contradicted());
}

}  // namespace
}  // namespace edged

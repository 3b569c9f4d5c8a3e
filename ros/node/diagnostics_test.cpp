// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/diagnostics.hpp"

#include <gmock/gmock.h>

namespace edged::node {
namespace {

using ::testing::HasSubstr;

std::string value_of(const Diagnosis& diagnosis, const std::string& key) {
  for (const auto& pair : diagnosis.values)
    if (pair.first == key) return pair.second;
  return "none";
}

NodeHealth good() {
  NodeHealth health;
  health.status = TrackingStatus::Good;
  health.inputs["/imu"].messages = 3;
  return health;
}

TEST(Diagnostics, LevelFollowsTheStatusAndWhatWasNewlyLost) {
  NodeHealth health = good();
  EXPECT_EQ(diagnose(health).level, Diagnosis::Level::Ok);
  health.newly_lost = 2;
  EXPECT_EQ(diagnose(health).level, Diagnosis::Level::Warning);
  EXPECT_THAT(diagnose(health).message, HasSubstr("2 measurements lost"));
  health.status = TrackingStatus::Lost;
  health.reason = "blind";
  EXPECT_EQ(diagnose(health).level, Diagnosis::Level::Error);
  EXPECT_THAT(diagnose(health).message, HasSubstr("Lost: blind"));
}

TEST(Diagnostics, ANodeThatIsTooSlowWarnsOfTheShareOfEventsThatItDrops) {
  NodeHealth health = good();
  health.inputs["/left/events"].events = 600;
  health.inputs["/right/events"].events = 400;
  health.dropped.events = health.newly_lost = 930;
  const Diagnosis status = diagnose(health);
  EXPECT_EQ(status.level, Diagnosis::Level::Warning);
  EXPECT_THAT(status.message, HasSubstr("Good"));
  EXPECT_THAT(status.message, HasSubstr("93 % of all events dropped"));
  EXPECT_EQ(value_of(status, "events left out, too slow [%]"), "93");
}

TEST(Diagnostics, ASilentTopicIsNamed) {
  NodeHealth health = good();
  health.inputs["/dvs/events"];
  EXPECT_THAT(diagnose(health).message, HasSubstr("nothing received on /dvs/events"));
}

TEST(Diagnostics, AnUnknownClockOfTheImuIsNamedWithTheRemedy) {
  NodeHealth health = good();
  health.imu_clock_unknown = true;
  EXPECT_EQ(diagnose(health).level, Diagnosis::Level::Warning);
  EXPECT_THAT(diagnose(health).message, HasSubstr("the offset of the IMU's clock is not known: turn the camera"));
}

TEST(Diagnostics, ATopicThatCannotComeIsNamedWithTheReason) {
  NodeHealth health = good();
  health.inputs["/imu"].transport_trouble = "a publisher is best effort";
  EXPECT_EQ(diagnose(health).level, Diagnosis::Level::Warning);
  EXPECT_THAT(diagnose(health).message, HasSubstr("/imu: a publisher is best effort"));
}

TEST(Diagnostics, EveryLossIsCountedAndShown) {
  NodeHealth health = good();
  health.inputs["/events"].missed = 1;
  health.inputs["/imu"].unreadable = 2;
  health.inputs["/imu"].missed = 66;
  health.inputs["/imu"].lost = 64;
  health.inputs["/imu"].refused = 3;
  health.dropped = {4, 8};
  health.odometry.intake.events_outside = 16;
  health.odometry.packets.frames_late = 32;
  EXPECT_EQ(lost_measurements(health), 130U);
  const Diagnosis status = diagnose(health);
  EXPECT_EQ(value_of(status, "/imu messages"), "3");
  EXPECT_EQ(value_of(status, "/events messages missed"), "1");
  EXPECT_EQ(value_of(status, "/imu messages refused, too slow"), "3");
  EXPECT_EQ(value_of(status, "/imu messages unreadable"), "2");
  EXPECT_EQ(value_of(status, "/imu messages lost by the transport"), "64");
  EXPECT_EQ(value_of(status, "events left out, too slow"), "4");
  EXPECT_EQ(value_of(status, "frames left out, too slow"), "8");
  EXPECT_EQ(value_of(status, "events outside the image"), "16");
  EXPECT_EQ(value_of(status, "frames late"), "32");
}

}  // namespace
}  // namespace edged::node

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "diagnostics.hpp"

#include <gmock/gmock.h>

namespace edged::ros1 {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using ::testing::HasSubstr;

std::string value_of(const DiagnosticStatus& status, const std::string& key) {
  for (const auto& pair : status.values)
    if (pair.key == key) return pair.value;
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
  EXPECT_EQ(diagnostics_message(health, "rig").level, DiagnosticStatus::OK);
  health.newly_lost = 2;
  EXPECT_EQ(diagnostics_message(health, "rig").level, DiagnosticStatus::WARN);
  EXPECT_THAT(diagnostics_message(health, "rig").message, HasSubstr("2 measurements lost"));
  health.status = TrackingStatus::Lost;
  health.reason = "blind";
  EXPECT_EQ(diagnostics_message(health, "rig").level, DiagnosticStatus::ERROR);
  EXPECT_THAT(diagnostics_message(health, "rig").message, HasSubstr("Lost: blind"));
}

TEST(Diagnostics, ASilentTopicIsNamed) {
  NodeHealth health = good();
  health.inputs["/dvs/events"];
  EXPECT_THAT(diagnostics_message(health, "rig").message, HasSubstr("nothing has come on /dvs/events"));
}

TEST(Diagnostics, EveryLossIsCountedAndShown) {
  NodeHealth health = good();
  health.inputs["/imu"].missed = 1;
  health.inputs["/imu"].unreadable = 2;
  health.left_out = {4, 8};
  health.odometry.intake.events_outside = 16;
  health.odometry.packets.frames_late = 32;
  EXPECT_EQ(lost_measurements(health), 63U);
  const DiagnosticStatus status = diagnostics_message(health, "rig");
  EXPECT_EQ(value_of(status, "/imu messages"), "3");
  EXPECT_EQ(value_of(status, "/imu messages missed"), "1");
  EXPECT_EQ(value_of(status, "/imu messages unreadable"), "2");
  EXPECT_EQ(value_of(status, "events left out, too slow"), "4");
  EXPECT_EQ(value_of(status, "frames left out, too slow"), "8");
  EXPECT_EQ(value_of(status, "events outside the image"), "16");
  EXPECT_EQ(value_of(status, "frames late"), "32");
}

}  // namespace
}  // namespace edged::ros1

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "topics/clock_check.hpp"

#include <gmock/gmock.h>

namespace edged::node {
namespace {

using ::testing::HasSubstr;

constexpr Timestamp after_s(double s) { return timestamp_from_seconds(1000.0 + s); }

/// What is said of an IMU whose clock has that speed, from the one time to the other.
std::vector<std::string> said_of(ClockCheck& check, double speed, double from_s, double to_s) {
  std::vector<std::string> said;
  for (double s = from_s; s < to_s; s += 0.01) {
    check.note("/events", after_s(s));
    if (auto wrong = check.note("/imu", after_s(speed * s))) said.push_back(*wrong);
  }
  return said;
}

TEST(ClockCheck, FindsStampsOfTwiceTheSpeedAndSaysSoOnce) {
  ClockCheck check("/events");
  const auto said = said_of(check, 2.0, 0.0, 20.0);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_THAT(said.front(), HasSubstr("/imu: its stamps run 2.00 times as fast as those of /events"));
  EXPECT_EQ(check.wrong(), 1U);
}

TEST(ClockCheck, AcceptsClocksThatAgreeWithGapsAndASilentReference) {
  ClockCheck check("/events");
  EXPECT_TRUE(said_of(check, 1.0, 0.0, 10.0).empty());
  for (double s = 10.0; s < 30.0; s += 0.01) EXPECT_FALSE(check.note("/imu", after_s(s)));  // no events
  EXPECT_TRUE(said_of(check, 1.0, 30.0, 40.0).empty());
  EXPECT_TRUE(said_of(check, 1.0, 0.0, 10.0).empty());  // played again
  EXPECT_EQ(check.wrong(), 0U);
}

}  // namespace
}  // namespace edged::node

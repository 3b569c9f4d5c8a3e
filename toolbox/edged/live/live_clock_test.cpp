// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/live_clock.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

const auto kNeverStopped = [] { return false; };

Timestamp clock_ms(int ms) { return Timestamp() + std::chrono::milliseconds(ms); }

TEST(LiveClock, WaitsAsLongAsTheStampsSay) {
  LiveClock clock;
  const auto begin = std::chrono::steady_clock::now();
  for (const int ms : {5000, 5010, 5030}) clock.wait_for(clock_ms(ms), kNeverStopped);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(30));
}

TEST(LiveClock, CountsTheTimeSinceAMeasurementWasDue) {
  LiveClock clock;
  EXPECT_EQ(clock.since_due_s(clock_ms(0)), 0.0);
  clock.wait_for(clock_ms(0), kNeverStopped);
  clock.wait_for(clock_ms(20), kNeverStopped);
  EXPECT_GE(clock.since_due_s(clock_ms(0)), 0.02);
  EXPECT_LT(clock.since_due_s(clock_ms(3'600'000)), 0.0);
}

TEST(LiveClock, WaitsNoLongerWhenStopped) {
  LiveClock clock;
  clock.wait_for(clock_ms(0), kNeverStopped);
  clock.wait_for(clock_ms(3'600'000), [] { return true; });
  EXPECT_LT(clock.since_due_s(clock_ms(3'600'000)), 0.0);
}

}  // namespace
}  // namespace edged

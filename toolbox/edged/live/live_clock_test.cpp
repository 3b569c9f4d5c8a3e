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

/// How late what comes at once seems after an hour [s]. ppm: by which the clock of the sensors is fast.
double late_after_an_hour_s(double ppm) {
  LiveClock::Clock::time_point now;
  LiveClock clock(Due::OnArrival, [&now] { return now; });
  const auto stamp = [ppm](int ms) { return timestamp_from_seconds(7.0 + 1e-3 * ms * (1 + 1e-6 * ppm)); };
  for (int ms = 0; ms <= 3'600'000; ms += 5) {
    now = LiveClock::Clock::time_point(std::chrono::milliseconds(ms));
    clock.wait_for(stamp(ms), kNeverStopped);
  }
  return clock.since_due_s(stamp(3'600'000));
}

TEST(LiveClock, FollowsTheClockOfSensorsThatDrifts) {
  for (const double ppm : {50.0, -50.0}) EXPECT_NEAR(late_after_an_hour_s(ppm), 0.0, 1.1e-3);
}

TEST(LiveClock, FollowsTheClockOfSensorsThatIsSet) {
  LiveClock::Clock::time_point now(std::chrono::seconds(1000));
  LiveClock clock(Due::OnArrival, [&now] { return now; });
  for (const int stamp_ms : {5000, 105'000, 4000}) {
    now += std::chrono::milliseconds(5);
    EXPECT_EQ(clock.wait_for(clock_ms(stamp_ms), kNeverStopped), now);
    EXPECT_EQ(clock.since_due_s(clock_ms(stamp_ms)), 0.0);
  }
}

TEST(LiveClock, WaitsNoLongerWhenStopped) {
  LiveClock clock;
  clock.wait_for(clock_ms(0), kNeverStopped);
  clock.wait_for(clock_ms(3'600'000), [] { return true; });
  EXPECT_LT(clock.since_due_s(clock_ms(3'600'000)), 0.0);
}

}  // namespace
}  // namespace edged

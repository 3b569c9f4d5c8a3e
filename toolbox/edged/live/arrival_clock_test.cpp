// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/arrival_clock.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

using std::chrono::milliseconds;

constexpr Duration kUnixNow = std::chrono::seconds(1'700'000'000);

Timestamp stamp_ms(int ms) { return Timestamp(milliseconds(ms)); }

TEST(ArrivalClock, AMeasurementThatIsLateDoesNotShiftTheOthers) {
  ArrivalClock clock;
  clock.arrived(stamp_ms(5000), kUnixNow + milliseconds(3));
  clock.arrived(stamp_ms(5010), kUnixNow + milliseconds(10));  // the least delay
  clock.arrived(stamp_ms(5020), kUnixNow + milliseconds(60));
  EXPECT_EQ(clock.at(stamp_ms(5020)), kUnixNow + milliseconds(20));
}

TEST(ArrivalClock, FollowsAClockThatDrifts) {
  ArrivalClock clock;
  for (int ms = 0; ms <= 3'600'000; ms += 5)  // an hour, slow by 100 ppm
    clock.arrived(stamp_ms(ms), kUnixNow + milliseconds(ms) + Duration(ms * 100LL));
  const Duration truth = kUnixNow + milliseconds(3'600'000) + milliseconds(360);
  EXPECT_LE(std::chrono::abs(clock.at(stamp_ms(3'600'000)) - truth), milliseconds(2));
}

TEST(ArrivalClock, AStampThatGoesBackBeginsANewTime) {
  ArrivalClock clock;
  clock.arrived(stamp_ms(5000), kUnixNow);
  clock.arrived(stamp_ms(100), kUnixNow + milliseconds(5));
  EXPECT_EQ(clock.at(stamp_ms(100)), kUnixNow + milliseconds(5));
}

TEST(ArrivalClock, OneSampleOutOfOrderOrDamagedChangesNothing) {
  ArrivalClock clock;
  clock.arrived(stamp_ms(5000), kUnixNow);
  clock.arrived(stamp_ms(4999), kUnixNow + milliseconds(50));
  clock.arrived(Timestamp::max(), kUnixNow + milliseconds(50));
  clock.arrived(stamp_ms(5010), kUnixNow + milliseconds(60));
  EXPECT_EQ(clock.at(stamp_ms(5010)), kUnixNow + milliseconds(10));
}

}  // namespace
}  // namespace edged

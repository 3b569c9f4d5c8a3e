// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "live_clock.hpp"

#include <gtest/gtest.h>

namespace edged {
namespace {

Timestamp at_ms(int ms) { return Timestamp() + std::chrono::milliseconds(ms); }

TEST(LiveClock, WaitsAsLongAsTheStampsSay) {
  LiveClock clock;
  const auto begin = std::chrono::steady_clock::now();
  for (const int ms : {5000, 5010, 5030}) clock.wait_for(at_ms(ms));
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(30));
}

TEST(LiveClock, CountsTheLatencyOfAResultFromWhenItsMeasurementWasDue) {
  LiveClock clock;
  EXPECT_EQ(clock.worst_latency_s(), 0.0);
  clock.wait_for(at_ms(0));
  clock.wait_for(at_ms(20));
  clock.note_result(at_ms(20));
  clock.note_result(at_ms(0));
  EXPECT_GE(clock.median_latency_s(), 0.02);
  EXPECT_GE(clock.worst_latency_s(), clock.median_latency_s());
}

}  // namespace
}  // namespace edged

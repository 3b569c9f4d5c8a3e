// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/checks/statistics/flicker_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace edged {
namespace {

/// Random events on 128 x 96 px; those left of `until_x` have the polarity of a light of 120 Hz.
std::optional<FlickerStatistics> statistics_of_lamp(int until_x) {
  std::mt19937 random(1);
  FlickerCollector collector({128, 96});
  for (int i = 0; i < 400'000; ++i) {
    const double t = 5e-6 * i;
    const auto x = static_cast<std::uint16_t>(random() % 128), y = static_cast<std::uint16_t>(random() % 96);
    const bool rises = std::cos(2.0 * std::numbers::pi * 120.0 * t) > 0.0;
    collector.add({timestamp_from_seconds(t), x, y, x < until_x ? rises : random() % 2 == 0});
  }
  return collector.result();
}

TEST(FlickerStatistics, GivesFrequencyEventsAndPartOfTheImage) {
  const auto half = statistics_of_lamp(64);
  ASSERT_TRUE(half);
  EXPECT_NEAR(half->hz, 120.0, 0.5);
  EXPECT_NEAR(half->image_share, 0.5, 1e-9);
  EXPECT_NEAR(half->event_share, 0.4, 0.05);  // polarities that swing as a square spread over all phases
  EXPECT_NEAR(half->time_share, 0.75, 0.1);   // one of the eight windows is not enough to be sure, one has not ended
}

TEST(FlickerStatistics, IsEmptyWithoutALamp) { EXPECT_FALSE(statistics_of_lamp(0)); }

TEST(FlickerStatistics, IgnoresEventsOutsideAndStampsThatDecrease) {
  FlickerCollector collector({128, 96});
  for (int i = 0; i < 10'000; ++i) collector.add({timestamp_from_seconds(10.0 - 1e-3 * i), 200, 0, true});
  for (int i = 0; i < 10'000; ++i) collector.add({timestamp_from_seconds(10.0 - 1e-3 * i), 127, 95, true});
  EXPECT_FALSE(collector.result());
}

}  // namespace
}  // namespace edged

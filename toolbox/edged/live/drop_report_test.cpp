// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/drop_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace edged {
namespace {

using testing::HasSubstr;

DropReport::Clock::time_point wall_ms(int ms) { return DropReport::Clock::time_point(std::chrono::milliseconds(ms)); }

TEST(DropReport, SaysNothingWhileNothingIsDropped) {
  DropReport report;
  for (const int ms : {0, 1000, 60000}) EXPECT_EQ(report.update({}, wall_ms(ms)), std::nullopt);
}

TEST(DropReport, TellsTheBeginningAndAfterAQuietSecondTheEndWithCounts) {
  DropReport report;
  EXPECT_THAT(report.update({100, 0}, wall_ms(0)).value_or(""), HasSubstr("oldest events"));
  EXPECT_EQ(report.update({300, 2}, wall_ms(700)), std::nullopt);
  EXPECT_EQ(report.update({300, 2}, wall_ms(1600)), std::nullopt);
  EXPECT_THAT(report.update({300, 2}, wall_ms(1700)).value_or(""), HasSubstr("300 events and 2 frames"));
  EXPECT_EQ(report.update({300, 2}, wall_ms(9000)), std::nullopt);
}

TEST(DropReport, TellsOfOnePeriodInTenSecondsAndOfTheOthersWithTheNext) {
  DropReport report;
  report.update({10, 0}, wall_ms(0));
  EXPECT_TRUE(report.update({10, 0}, wall_ms(1000)));
  EXPECT_EQ(report.update({30, 0}, wall_ms(5000)), std::nullopt);
  EXPECT_EQ(report.update({30, 0}, wall_ms(7000)), std::nullopt);
  EXPECT_TRUE(report.update({60, 0}, wall_ms(10000)));
  EXPECT_THAT(report.update({60, 0}, wall_ms(11000)).value_or(""), HasSubstr(" 50 events"));
}

}  // namespace
}  // namespace edged

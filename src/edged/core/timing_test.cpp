// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/timing.hpp"

#include <gtest/gtest.h>

#include <string>

namespace edged {
namespace {

TEST(StageTiming, IsZeroBeforeTheFirstCall) {
  const StageTiming timing;
  EXPECT_EQ(timing.count(), 0u);
  EXPECT_EQ(timing.mean_s(), 0.0);
  EXPECT_EQ(timing.quantile_s(0.5), 0.0);
}

TEST(StageTiming, GivesQuantilesToFivePercent) {
  StageTiming timing;
  for (int i = 1; i <= 1000; ++i) timing.add(i * 1e-4);
  EXPECT_EQ(timing.count(), 1000u);
  EXPECT_NEAR(timing.mean_s(), 0.05005, 1e-9);
  EXPECT_NEAR(timing.total_s(), 50.05, 1e-9);
  EXPECT_EQ(timing.max_s(), 0.1);
  EXPECT_NEAR(timing.quantile_s(0.5), 0.05, 0.05 * 0.051);
  EXPECT_NEAR(timing.quantile_s(0.95), 0.095, 0.095 * 0.051);
  EXPECT_LE(timing.quantile_s(1.0), timing.max_s());
}

TEST(StageTiming, TakesDurationsOutsideItsBins) {
  StageTiming timing;
  timing.add(0.0);
  timing.add(1e6);
  EXPECT_EQ(timing.count(), 2u);
  EXPECT_EQ(timing.max_s(), 1e6);
  EXPECT_LE(timing.quantile_s(0.5), 1.1e-6);
}

TEST(StageTimings, ListsStagesInTheOrderOfTheirFirstUse) {
  StageTimings timings;
  { const auto scope = timings.measure("warp"); }
  { const auto scope = timings.measure("detect"); }
  { const auto scope = timings.measure("warp"); }
  ASSERT_EQ(timings.all().size(), 2u);
  EXPECT_EQ(timings.all()[0].name, "warp");
  EXPECT_EQ(timings.all()[0].timing.count(), 2u);
  EXPECT_EQ(timings.all()[1].name, "detect");
}

TEST(StageTimings, HaveProcessorTimeWhereItWasAskedFor) {
  StageTimings timings;
  { const auto scope = timings.measure("warp"); }
  { const auto scope = timings.measure_often("read"); }
  ASSERT_TRUE(timings.all()[0].timing.cpu_s().has_value());
  EXPECT_GE(*timings.all()[0].timing.cpu_s(), 0.0);
  EXPECT_FALSE(timings.all()[1].timing.cpu_s().has_value());
}

TEST(StageTimings, TakeAStageThatWasMeasuredElsewhere) {
  StageTiming reading;
  reading.add(0.5);
  reading.add(0.25);
  reading.add_cpu(0.6);
  StageTimings timings;
  timings.put("read", reading);
  EXPECT_EQ(timings.find("read")->count(), 2u);
  EXPECT_EQ(timings.find("read")->total_s(), 0.75);
  EXPECT_EQ(timings.find("read")->cpu_s(), 0.6);
}

TEST(StageTimings, NestedScopesOfNewStagesStayValid) {
  StageTimings timings;
  {
    const auto outer = timings.measure("outer");
    for (int i = 0; i < 40; ++i) const auto inner = timings.measure("inner " + std::to_string(i));
  }
  EXPECT_EQ(timings.all()[0].timing.count(), 1u);
  EXPECT_EQ(timings.all().size(), 41u);
}

}  // namespace
}  // namespace edged

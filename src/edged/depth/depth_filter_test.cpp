// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Eq. 4 with a time step, validity, holding and age.
#include "edged/depth/depth_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "edged/core/check.hpp"

namespace edged {
namespace {

Timestamp at_s(double s) { return timestamp_from_seconds(s); }

DepthFilterConfig config() {
  DepthFilterConfig c;
  c.min_m = 0.5, c.max_m = 10.0, c.time_constant_s = 0.2, c.max_age_s = 1.0, c.drift = 0.3;
  return c;
}

TEST(DepthFilter, KnowsNothingBeforeTheFirstMeasurement) { EXPECT_FALSE(DepthFilter(config()).at(at_s(0))); }

TEST(DepthFilter, StartsWithTheFirstValidMeasurement) {
  DepthFilter filter(config());
  EXPECT_FALSE(filter.add({at_s(0), 0.4, 0.1, 0.2}));
  EXPECT_FALSE(filter.add({at_s(0), std::nan(""), 0.1, 0.2}));
  EXPECT_TRUE(filter.add({at_s(0.1), 3.0, 0.1, 0.2}));
  const auto held = filter.at(at_s(0.1));
  ASSERT_TRUE(held);
  EXPECT_EQ(held->depth_m, 3.0);
  EXPECT_EQ(held->t, at_s(0.1));
  EXPECT_EQ(held->sigma_ln, 0.1);
  EXPECT_EQ(held->spread_ln, 0.2);
}

TEST(DepthFilter, SmoothsInLogDepth) {
  DepthFilter filter(config());
  filter.add({at_s(0), 2.0, 0.1, 0.0});
  filter.add({at_s(0.2 * std::log(2.0)), 8.0, 0.1, 0.0});  // share of the new one: 1 - exp(-ln 2) = one half
  EXPECT_NEAR(filter.at(at_s(0.2))->depth_m, 4.0, 1e-6);
}

TEST(DepthFilter, EndsAtTheSameDepthForAnyRateOfMeasurements) {
  DepthFilter slow(config()), fast(config());
  slow.add({at_s(0), 1.0, 0.1, 0.0}), fast.add({at_s(0), 1.0, 0.1, 0.0});
  slow.add({at_s(0.3), 5.0, 0.1, 0.0});
  for (int i = 1; i <= 30; ++i) fast.add({at_s(0.01 * i), 5.0, 0.1, 0.0});
  EXPECT_NEAR(slow.at(at_s(0.3))->depth_m, fast.at(at_s(0.3))->depth_m, 1e-9);
}

TEST(DepthFilter, HoldsTheEstimateOverRejectedMeasurements) {
  DepthFilter filter(config());
  filter.add({at_s(0), 2.0, 0.1, 0.0});
  for (const double bad : {0.0, -3.0, 0.5, 10.0, 80.0}) EXPECT_FALSE(filter.add({at_s(0.5), bad, 0.1, 0.0}));
  EXPECT_EQ(filter.at(at_s(0.5))->depth_m, 2.0);
  EXPECT_EQ(filter.at(at_s(0.5))->t, at_s(0));
}

TEST(DepthFilter, GivesUpWithAgeAndStartsAfresh) {
  DepthFilter filter(config());
  filter.add({at_s(0), 2.0, 0.1, 0.0});
  EXPECT_TRUE(filter.at(at_s(1.0)));
  EXPECT_FALSE(filter.at(at_s(1.001)));
  filter.add({at_s(1.5), 8.0, 0.1, 0.0});
  EXPECT_EQ(filter.at(at_s(1.5))->depth_m, 8.0);
}

TEST(DepthFilter, GrowsLessSureWithAge) {
  DepthFilter filter(config());
  filter.add({at_s(0), 2.0, 0.4, 0.0});
  EXPECT_NEAR(filter.at(at_s(1.0))->sigma_ln, 0.5, 1e-12);
}

TEST(DepthFilter, IgnoresWhatIsOlderThanItsEstimate) {
  DepthFilter filter(config());
  filter.add({at_s(1.0), 2.0, 0.1, 0.0});
  EXPECT_FALSE(filter.add({at_s(0.9), 8.0, 0.1, 0.0}));
  EXPECT_EQ(filter.at(at_s(1.0))->depth_m, 2.0);
}

TEST(DepthFilter, ListsItsOptions) {
  DepthFilterConfig c;
  ConfigFields fields = ConfigFields::of(c);
  EXPECT_EQ(fields.all().size(), 3U);
  EXPECT_THROW(fields.set("time_constant_s=-1"), InputError);
}

}  // namespace
}  // namespace edged

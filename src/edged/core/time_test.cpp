// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/time.hpp"

#include <gtest/gtest.h>

#include <concepts>
#include <cstdint>

namespace edged {
namespace {

template <typename T>
concept Addable = requires(T a, T b) {
  a + b;
};

TEST(Time, StampsCannotBeAdded) {
  static_assert(!Addable<Timestamp>);
  static_assert(Addable<Duration>);
  static_assert(std::same_as<decltype(Timestamp{} - Timestamp{}), Duration>);
}

TEST(Time, RoundsSecondsToTheNearestNanosecondOnBothSidesOfZero) {
  EXPECT_EQ(duration_from_seconds(1.4e-9).count(), 1);
  EXPECT_EQ(duration_from_seconds(1.6e-9).count(), 2);
  EXPECT_EQ(duration_from_seconds(-1.4e-9).count(), -1);
  EXPECT_EQ(duration_from_seconds(-1.6e-9).count(), -2);
  EXPECT_EQ(duration_from_seconds(0.1).count(), 100'000'000);
}

TEST(Time, KeepsUnixStampsToTheNanosecond) {
  constexpr std::int64_t kNs = 1'403'715'529'112'143'517;
  EXPECT_EQ(to_ns(timestamp_from_ns(kNs)), kNs);
  EXPECT_EQ((timestamp_from_ns(kNs + 1) - timestamp_from_ns(kNs)).count(), 1);
}

TEST(Time, TurnsDurationsIntoSeconds) {
  EXPECT_DOUBLE_EQ(to_seconds(Duration(1'500'000'000)), 1.5);
  EXPECT_DOUBLE_EQ(to_seconds(timestamp_from_seconds(2.25)), 2.25);
}

}  // namespace
}  // namespace edged

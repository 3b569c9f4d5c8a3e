// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/measurements/jump_gate.hpp"

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <string>
#include <vector>

namespace edged {
namespace {

struct Item {
  Timestamp t;
};

Item item(int s) { return {timestamp_from_seconds(s)}; }

/// A gate with a log of its items: "1 2 -3600 3", dropped ones with a minus.
struct Gate {
  JumpGate<Item> gate;
  std::string told = {};

  void tell(const char* sign, const Item& i) { told += fmt::format("{}{} ", sign, to_seconds(i.t)); }
  auto pass() {
    return [this](const Item& i) { tell("", i); };
  }
  Gate& push(std::initializer_list<int> stamps) {
    for (const int s : stamps) gate.push(item(s), pass(), [this](const Item& i, Timestamp) { tell("-", i); });
    return *this;
  }
};

TEST(JumpGate, DropsOneStampFarAheadAndKeepsAGapThatIsConfirmed) {
  EXPECT_EQ(Gate{JumpGate<Item>(false)}.push({1, 2, 3600, 3, 4}).told, "1 2 -3600 3 4 ");
  EXPECT_EQ(Gate{JumpGate<Item>(false)}.push({1, 2, 3600, 3601}).told, "1 2 3600 3601 ");
  EXPECT_EQ(Gate{JumpGate<Item>(false)}.push({1, 2, 3600, 7200, 3}).told, "1 2 3600 -7200 3 ");
}

TEST(JumpGate, TheFirstOfAllWaitsOnlyWhereItIsTold) {
  EXPECT_EQ(Gate{JumpGate<Item>(true)}.push({3600, 1, 2}).told, "-3600 1 2 ");
  EXPECT_EQ(Gate{JumpGate<Item>(false)}.push({3600}).told, "3600 ");
}

TEST(JumpGate, GivesWhatWaitsAtTheEnd) {
  Gate gate{JumpGate<Item>(false)};
  gate.push({1, 3600});
  EXPECT_TRUE(gate.gate.waits());
  gate.gate.finish(gate.pass());
  EXPECT_EQ(gate.told, "1 3600 ");
}

TEST(JumpGate, AnotherStreamConfirmsWhatIsNearIt) {
  Gate gate{JumpGate<Item>(false)};
  gate.push({1, 100});
  gate.gate.confirm(timestamp_from_seconds(2), gate.pass());
  EXPECT_EQ(gate.told, "1 ");
  gate.gate.confirm(timestamp_from_seconds(99), gate.pass());
  EXPECT_EQ(gate.told, "1 100 ");
  gate.gate.confirm(timestamp_from_seconds(200), gate.pass());
  gate.push({201});
  EXPECT_EQ(gate.told, "1 100 201 ");
}

TEST(JumpGate, TakesManyAtOnceByTheNewestOfThem) {
  Gate gate{JumpGate<Item>(false)};
  EXPECT_FALSE(gate.gate.passes(timestamp_from_seconds(1))) << "the first has none before it";
  gate.push({1});
  EXPECT_TRUE(gate.gate.passes(timestamp_from_seconds(2)));
  EXPECT_EQ(gate.gate.newest(), timestamp_from_seconds(2));
  EXPECT_FALSE(gate.gate.passes(timestamp_from_seconds(3600)));
  EXPECT_EQ(gate.gate.newest(), timestamp_from_seconds(2));
  gate.push({3600});
  EXPECT_FALSE(gate.gate.passes(timestamp_from_seconds(3))) << "while one is held";
}

}  // namespace
}  // namespace edged

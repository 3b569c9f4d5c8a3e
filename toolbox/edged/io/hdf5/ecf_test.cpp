// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// ECF: bytes encoded by hand from the description of the format, generated events, damage.
#include "edged/io/hdf5/h5_filters.hpp"

#include <gtest/gtest.h>

#include <random>

#include "edged/io/hdf5/ecf_test_support.hpp"

namespace edged {
namespace {

constexpr std::size_t kMost = 65536;

/// Events as a sensor sends them: row by row within a stamp, with runs of neighbours, and gaps in time.
std::vector<EcfEvent> sensor_events(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<EcfEvent> events;
  std::int64_t t = 5'000'000'000;
  std::uint16_t y = 0;
  while (events.size() < count) {
    if (random() % 4 == 0) t += random() % 16 == 0 ? random() % 1'000'000 : random() % 20;
    if (random() % 3 == 0) y = static_cast<std::uint16_t>(random() % 720);
    const auto p = static_cast<std::int16_t>(random() % 16 == 0);
    auto x = static_cast<std::uint16_t>(random() % 1270);
    const std::size_t neighbours = random() % 8 == 0 ? 200 : random() % 8;
    for (std::size_t i = 0; i <= neighbours && events.size() < count && x < 1280; ++i) {
      events.push_back({x, y, p, 0, t});
      x = static_cast<std::uint16_t>(x + 1 + random() % 3);
    }
  }
  return events;
}

TEST(Ecf, OneEventIsAStampAndThreeWords) {
  // 1 event, all side by side; t = 4; a step of 0 once; y 2, x 1, p 0 in the highest 24 of 96 bits.
  const Bytes packed{6, 0, 0, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0x01, 0x00, 0x02, 0x20, 0x00, 0, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_TRUE(decode_ecf(packed, kMost) == (std::vector<EcfEvent>{{1, 2, 0, 0, 4}}));
}

TEST(Ecf, StepsOfFifteenAndMoreComeInNibblesLowestFirst) {
  // 2 events in runs; t = 0, then a step of 0x123; y 3 twice; x 8 and 10 by the mask; p 1 twice.
  const Bytes packed{8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x01, 0xf3, 0xf2, 0xf1, 0x01, 0x62, 0x00, 0x08, 0x01, 0x82};
  EXPECT_TRUE(decode_ecf(packed, kMost) == (std::vector<EcfEvent>{{8, 3, 1, 0, 0}, {10, 3, 1, 0, 0x123}}));
}

TEST(Ecf, ColumnsSideBySideTakeTwelveBits) {
  // 4 events, t 7 for all; y 1 for all; x 0x401 .. 0x404, p 1 0 1 0: 0x803, 0x804, 0x807, 0x808.
  const Bytes packed{17, 0, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0, 0x04, 0x24, 0x00, 0x34, 0x80, 0x07, 0x80, 0x08, 0x88};
  EXPECT_TRUE(
      decode_ecf(packed, kMost) ==
      (std::vector<EcfEvent>{{0x401, 1, 1, 0, 7}, {0x402, 1, 0, 0, 7}, {0x403, 1, 1, 0, 7}, {0x404, 1, 0, 0, 7}}));
}

TEST(Ecf, GivesBackWhatWasPackedInEveryWay) {
  for (const auto packing : {EcfPacking::Runs, EcfPacking::ColumnsSideBySide, EcfPacking::AllSideBySide})
    for (const std::size_t count : {0, 1, 3, 4, 5, 1000, 16384}) {
      const std::vector<EcfEvent> events = sensor_events(count, static_cast<unsigned>(count));
      EXPECT_TRUE(decode_ecf(encode_ecf(events, packing), kMost) == events) << count;
    }
}

TEST(Ecf, LongRunsOfEqualValuesAreCountedInTwoBytes) {
  const std::vector<EcfEvent> events(40'000, EcfEvent{5, 6, 1, 0, 77});
  EXPECT_TRUE(decode_ecf(encode_ecf(events, EcfPacking::Runs), kMost) == events);
}

TEST(Ecf, CutAnywhereItIsRefused) {
  for (const auto packing : {EcfPacking::Runs, EcfPacking::ColumnsSideBySide, EcfPacking::AllSideBySide}) {
    const Bytes whole = encode_ecf(sensor_events(500, 1), packing);
    for (std::size_t size = 0; size < whole.size(); ++size)
      EXPECT_THROW(decode_ecf(ByteSpan(whole).first(size), kMost), Damage) << size;
  }
}

TEST(Ecf, FlippedBitsAreRefusedOrGiveAsManyEventsAsTheCountSays) {
  std::mt19937 random(3);
  for (const auto packing : {EcfPacking::Runs, EcfPacking::ColumnsSideBySide, EcfPacking::AllSideBySide}) {
    const Bytes whole = encode_ecf(sensor_events(500, 1), packing);
    for (int i = 0; i < 1000; ++i) {
      Bytes damaged = whole;
      damaged[random() % whole.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
      try {
        EXPECT_LE(decode_ecf(damaged, 1000).size(), 1000u);
      } catch (const Damage&) {
      }
    }
  }
}

TEST(Ecf, MoreEventsThanAChunkHoldsAreRefused) {
  EXPECT_THROW(decode_ecf(encode_ecf(sensor_events(500, 1), EcfPacking::Runs), 499), Damage);
}

}  // namespace
}  // namespace edged

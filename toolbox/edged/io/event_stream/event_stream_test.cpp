// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Event Stream files of DVS and ATIS cameras: generated ones, damage, refusals.
#include "edged/io/event_stream/event_stream.hpp"

#include <gmock/gmock.h>

#include "edged/io/damage_test_support.hpp"
#include "edged/io/parse/evt_test_support.hpp"

namespace edged {
namespace {

using ::testing::HasSubstr;

constexpr int kEsWidth = 640, kEsHeight = 480;

std::string es_header(char version, char kind) {
  std::string out = std::string("Event Stream") + version + std::string(2, '\0') + kind;
  append_number(out, std::uint16_t{kEsWidth});
  append_number(out, std::uint16_t{kEsHeight});
  return out;
}

void put_event(std::string& out, unsigned first, int x, int y) {
  out += static_cast<char>(first);
  append_number(out, static_cast<std::uint16_t>(x));
  append_number(out, static_cast<std::uint16_t>(kEsHeight - 1 - y));
}

std::string made_dvs(const std::vector<Event>& events) {
  std::string out = es_header(2, 1);
  std::int64_t last_us = 0;
  for (const Event& e : events) {
    const std::int64_t step_us = to_ns(e.t) / 1000 - last_us;
    out += std::string(static_cast<std::size_t>(step_us / 127), '\xFF');
    put_event(out, static_cast<unsigned>(step_us % 127) << 1U | (e.positive ? 1U : 0U), e.x, e.y);
    last_us += step_us;
    if (e.x % 64 == 0) out += std::string(5, '\xFE');  // reset
  }
  return out;
}

/// With a threshold crossing after each event, and up to three units of time in a byte.
std::string made_atis(const std::vector<Event>& events) {
  std::string out = es_header(2, 2);
  std::int64_t last_us = 0;
  for (const Event& e : events) {
    std::int64_t step_us = to_ns(e.t) / 1000 - last_us;
    last_us += step_us;
    for (; step_us / 63 > 0; step_us -= 63 * std::min<std::int64_t>(3, step_us / 63))
      out += static_cast<char>(0xFC + std::min<std::int64_t>(3, step_us / 63));
    put_event(out, static_cast<unsigned>(step_us) << 2U | (e.positive ? 2U : 0U), e.x, e.y);
    put_event(out, 1U | (e.positive ? 2U : 0U), e.x, e.y);
  }
  return out;
}

TEST(EventStreamFile, EventsOfDvsAndAtisAreReadWithTheirRowsFromAbove) {
  const TempFolder folder;
  const std::vector<Event> events = generated_events(200'000, kEsWidth, kEsHeight, 200);
  for (const std::string& file : {made_dvs(events), made_atis(events)}) {
    const Recording recording = open_recording(folder.write("a.bin", file));
    const DatasetInfo& info = recording.dataset->info();
    EXPECT_TRUE(info.has_events && !info.has_frames && !info.has_imu);
    EXPECT_EQ(info.event_sensor, cv::Size(kEsWidth, kEsHeight));
    EXPECT_EQ(info.begin, events.front().t);
    EXPECT_TRUE(read_all(*recording.dataset).events == events);
    EXPECT_TRUE(recording.dataset->repairs().empty());
  }
}

TEST(EventStreamFile, TheBytesOfTheDescriptionGiveItsValues) {
  const TempFolder folder;
  // 2 x 127 us, then 3 us; brighter; column 0x102, row 0x10 from below.
  const std::string file = es_header(2, 1) + "\xFF\xFF\x07\x02\x01\x10" + std::string(1, '\0');
  const Contents c = read_all(*open_recording(folder.write("a.es", file)).dataset);
  ASSERT_EQ(c.events.size(), 1u);
  EXPECT_EQ(c.events[0], (Event{timestamp_from_ns(257'000), 0x102, kEsHeight - 1 - 0x10, true}));
}

TEST(EventStreamFile, CutAnywhereItGivesWhatCameBefore) {
  const TempFolder folder;
  const std::vector<Event> events = generated_events(2000, kEsWidth, kEsHeight, 50);
  EXPECT_GT(expect_beginnings(folder, made_dvs(events), events), 1900u);
  EXPECT_EQ(read_damaged(folder, made_dvs(events) + "\x07\x02").repairs.at("file: cut"), 1u);
  for (std::size_t size = 12; size < 20; ++size)
    EXPECT_THAT(read_damaged(folder, made_dvs(events).substr(0, size)).refusal, HasSubstr("header is damaged")) << size;
}

TEST(EventStreamFile, FlippedBitsAndLostBytesCostFewEvents) {
  constexpr std::size_t kLongestRow = 40;  // of generated events
  const TempFolder folder;
  const std::vector<Event> events = generated_events(2000, kEsWidth, kEsHeight, 50);
  for (const std::string& whole : {made_dvs(events), made_atis(events)}) {
    std::mt19937 random(5);
    for (std::size_t i = 0; i < 200; ++i) {
      read_damaged(folder, flip_bits(whole, random, 0, 30));
      const DamagedRead flipped = read_damaged(folder, flip_bits(whole, random, 20, whole.size()));
      const DamagedRead lost = read_damaged(folder, std::string(whole).erase(20 + random() % (whole.size() - 20), 1));
      for (const DamagedRead& read : {flipped, lost}) {
        EXPECT_EQ(read.refusal, "");
        // In the lowest and highest rows, words from the wrong place lie within the sensor too: at most one row is
        // lost.
        EXPECT_GE(read.events.size(), events.size() - kLongestRow);
        EXPECT_LE(std::abs(to_seconds(read.events.back().t - events.back().t)), kLongestRow * 127e-6);
      }
    }
  }
}

TEST(EventStreamFile, WhatIsNotReadIsRefusedByName) {
  const TempFolder folder;
  const auto refusal = [&](const std::string& bytes) { return read_damaged(folder, bytes + "0123456789").refusal; };
  EXPECT_THAT(refusal(es_header(1, 1)), HasSubstr("Event Stream 1.0 is not read"));
  EXPECT_THAT(refusal(es_header(2, 0)), HasSubstr("holds generic events"));
  EXPECT_THAT(refusal(es_header(2, 3)), HasSubstr("holds display events"));
  EXPECT_THAT(refusal(es_header(2, 4)), HasSubstr("holds colour events"));
  EXPECT_THAT(refusal(es_header(2, 5)), HasSubstr("holds unknown events"));
  EXPECT_THAT(read_damaged(folder, es_header(2, 1)).refusal, HasSubstr("holds no events"));
  EXPECT_THAT(refusal("Event Stream of a text"), HasSubstr("unknown file format"));
}

}  // namespace
}  // namespace edged

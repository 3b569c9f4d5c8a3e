// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Decoders of the Prophesee formats against encoders, wraps, cuts and noise.
#include "edged/io/parse/evt.hpp"

#include <gtest/gtest.h>

#include <random>

#include "edged/io/parse/evt_test_support.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

constexpr int kWidth = 1280, kHeight = 720;

class EvtRoundTrip : public ::testing::TestWithParam<EvtFormat> {};

std::vector<Event> decode_all(EvtDecoder& decoder, const std::string& bytes, std::size_t chunk) {
  std::vector<Event> events;
  for (std::size_t i = 0; i < bytes.size(); i += chunk)
    decoder.decode(as_bytes(bytes).subspan(i, std::min(chunk, bytes.size() - i)), events);
  return events;
}

TEST_P(EvtRoundTrip, GivesBackEveryEventHoweverTheBytesAreCut) {
  const std::vector<Event> events = generated_events(20'000, kWidth, kHeight, 50);
  const std::string bytes = AnyEvtEncoder(GetParam()).encode(events);
  for (const std::size_t chunk : {std::size_t{1}, std::size_t{3}, std::size_t{7}, std::size_t{4096}, bytes.size()}) {
    EvtDecoder decoder(GetParam(), kWidth, kHeight);
    EXPECT_TRUE(decode_all(decoder, bytes, chunk) == events) << chunk;
    EXPECT_EQ(decoder.counts().outside + decoder.counts().untimed + decoder.counts().unknown, 0u);
  }
}

TEST_P(EvtRoundTrip, TimeGoesOnWhereTheCounterWraps) {
  // 7 h by steps below half the counter of each format: EVT 3 wraps 1500 times, EVT 2 once, DAT five times.
  const std::vector<Event> events = generated_events(80'000, kWidth, kHeight, 3'300'000);
  ASSERT_GT(to_seconds(events.back().t), 5 * 3600.0);
  EvtDecoder decoder(GetParam(), kWidth, kHeight);
  EXPECT_TRUE(decode_all(decoder, AnyEvtEncoder(GetParam()).encode(events), 1000) == events);
}

TEST_P(EvtRoundTrip, EventsOutsideTheSensorAreCountedAndLeftOut) {
  const std::vector<Event> events = generated_events(20'000, kWidth, kHeight, 50);
  std::vector<Event> inside;
  for (const Event& e : events)
    if (e.x < 640 && e.y < 480) inside.push_back(e);
  EvtDecoder decoder(GetParam(), 640, 480);
  EXPECT_TRUE(decode_all(decoder, AnyEvtEncoder(GetParam()).encode(events), 4096) == inside);
  EXPECT_EQ(decoder.counts().outside, events.size() - inside.size());
}

TEST_P(EvtRoundTrip, AFlippedBitLeavesLaterEventsTheirTimes) {
  const std::vector<Event> events = generated_events(2000, kWidth, kHeight, 50);
  const std::string bytes = AnyEvtEncoder(GetParam()).encode(events);
  std::mt19937 random(3);
  for (int i = 0; i < 2000; ++i) {
    std::string damaged = bytes;
    const std::size_t at = random() % (bytes.size() / 2);
    damaged[at] = static_cast<char>(damaged[at] ^ 1 << random() % 8);
    EvtDecoder decoder(GetParam(), kWidth, kHeight);
    const std::vector<Event> read = decode_all(decoder, damaged, 512);
    ASSERT_FALSE(read.empty());
    ASSERT_EQ(read.back(), events.back()) << "byte " << at;
  }
}

TEST_P(EvtRoundTrip, NoiseNeverLeavesTheSensor) {
  std::mt19937 random(11);
  EvtDecoder decoder(GetParam(), 320, 240);
  for (int i = 0; i < 1000; ++i) {
    std::string noise(random() % 3000, '\0');
    for (char& c : noise) c = static_cast<char>(random());
    std::vector<Event> events;
    decoder.decode(as_bytes(noise), events);
    for (const Event& e : events) ASSERT_TRUE(e.x < 320 && e.y < 240);
    if (i % 100 == 0) decoder.reset();
  }
  EXPECT_GT(decoder.counts().outside, 0u);
}

TEST_P(EvtRoundTrip, AfterAResetTheStreamBeginsAnew) {
  const std::vector<Event> events = generated_events(1000, kWidth, kHeight, 50);
  const std::string bytes = AnyEvtEncoder(GetParam()).encode(events);
  EvtDecoder decoder(GetParam(), kWidth, kHeight);
  decode_all(decoder, bytes.substr(0, bytes.size() / 2 + 1), 100);
  decoder.reset();
  EXPECT_TRUE(decode_all(decoder, bytes, 100) == events);
}

INSTANTIATE_TEST_SUITE_P(, EvtRoundTrip,
                         ::testing::Values(EvtFormat::Evt2, EvtFormat::Evt21, EvtFormat::Evt21Legacy, EvtFormat::Evt3,
                                           EvtFormat::Dat, EvtFormat::Evt4));

TEST(EvtDecoder, EventsBeforeTheFirstTimeAreCounted) {
  std::string bytes = AnyEvtEncoder(EvtFormat::Evt2).encode(generated_events(10, 100, 100, 1));
  std::vector<Event> events;
  EvtDecoder decoder(EvtFormat::Evt2, 100, 100);
  decoder.decode(as_bytes(bytes).subspan(4), events);  // without the first word
  EXPECT_TRUE(events.empty());
  EXPECT_EQ(decoder.counts().untimed, 10u);
}

TEST(EvtDecoder, ReadsTheWordsOfTheDocumentation) {
  // 0x0102030405060708 as the IMX636 sends it, and as the GenX320 does: type 0, so 4 events of row 0x304.
  std::vector<Event> imx636, genx320;
  const auto read = [](EvtFormat format, const std::string& bytes) {
    std::vector<Event> events;
    EvtDecoder(format, 2048, 2048).decode(as_bytes(bytes), events);
    return events;
  };
  const std::string high_legacy{'\0', '\0', '\0', '\x80', '\0', '\0', '\0', '\0'};
  const std::string high{'\0', '\0', '\0', '\0', '\0', '\0', '\0', '\x80'};
  const auto a = read(EvtFormat::Evt21Legacy, high_legacy + "\x04\x03\x02\x01\x08\x07\x06\x05");
  const auto b = read(EvtFormat::Evt21, high + "\x08\x07\x06\x05\x04\x03\x02\x01");
  ASSERT_EQ(a.size(), 8u);  // bits set in 0x05060708
  EXPECT_TRUE(a == b);
  EXPECT_EQ(a[0], (Event{timestamp_from_ns(4000), 0x40 + 3, 0x304, false}));
}

TEST(EvtDecoder, ReadsTheWordsOfEvt4) {
  std::string bytes;
  for (const std::uint32_t word :
       {0xE0000001U,                              // 64 us
        0xB0000000U | 5U << 22 | 100U << 11 | 7,  // brighter, 5 us later
        0xFFFFFFFFU, 0x60140000U, 0x70000000U,    // padding, a counter of the sensor in two words
        0xC0000000U | 9U << 22 | 31U << 11 | 8,   // darker, in the columns of the next word
        0xE0000001U,                              // columns 31, 60, 61, 62, and no time
        0x90000000U | 1U << 22 | 3U << 8 | 1,     // rising edge at input 3
        0x30000000U}) {                           // a type that the format does not have
    append_number(bytes, word);
  }
  std::vector<Event> events;
  EvtDecoder decoder(EvtFormat::Evt4, 2048, 2048);
  decoder.decode(as_bytes(bytes), events);
  const auto at = [](std::int64_t t_us, std::uint16_t x, std::uint16_t y, bool positive) {
    return Event{timestamp_from_ns(t_us * 1000), x, y, positive};
  };
  EXPECT_TRUE(events == (std::vector<Event>{at(69, 100, 7, true), at(73, 31, 8, false), at(73, 60, 8, false),
                                            at(73, 61, 8, false), at(73, 62, 8, false)}));
  EXPECT_EQ(decoder.counts().unknown, 1u);
  ASSERT_EQ(decoder.triggers().count(3), 1u);
  EXPECT_EQ(decoder.triggers().at(3)[1].first_us, 65);
}

TEST(EvtDecoder, UnknownWordsArePassedOverAndCounted) {
  const std::vector<Event> events = generated_events(100, 640, 480, 5);
  const std::string bytes = AnyEvtEncoder(EvtFormat::Evt3).encode(events);
  std::vector<Event> read;
  EvtDecoder decoder(EvtFormat::Evt3, 640, 480);
  decoder.decode(as_bytes(std::string{'\x12', '\x90'} + bytes), read);
  EXPECT_TRUE(read == events);
  EXPECT_EQ(decoder.counts().unknown, 1u);
}

}  // namespace
}  // namespace edged

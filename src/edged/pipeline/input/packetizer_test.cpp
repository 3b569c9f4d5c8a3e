// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// When the packetizer cuts packets, and which events and frames they contain.
#include "edged/pipeline/input/packetizer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "edged/core/check.hpp"
#include "edged/pipeline/input/packetizer_test_support.hpp"

namespace edged {
namespace {

TEST(Packetizer, CutsAfterAGivenNumberOfEvents) {
  // 1 event/ms with limits that do not bind: every 35 ms.
  const PacketizerResult result = packetize(TestStream().imu(-10, 400, 1).events(0, 350, 1), Mode::Events);
  ASSERT_GE(result.packets.size(), 9U);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(result.packets[i].events[0].new_events, kCut);
    EXPECT_EQ(result.packets[i].t, result.packets[i].events[0].events.back().t);
    EXPECT_NEAR(to_ms(result.packets[i].t), 34.0 + 35.0 * static_cast<double>(i), 1e-6);
    EXPECT_NEAR(result.packets[i].events[0].event_rate_hz, 1000.0, 30.0);
  }
}

TEST(Packetizer, CutsAfterTheLongestTimeWhenEventsAreFew) {
  const PacketizerResult result = packetize(TestStream().imu(-10, 500, 1).events(0, 450, 3), Mode::Events);
  ASSERT_GE(result.packets.size(), 10U);
  for (std::size_t i = 1; i < 10; ++i) {
    EXPECT_EQ(result.packets[i].t - result.packets[i - 1].t, duration_from_seconds(0.04));
  }
}

TEST(Packetizer, KeepsTheShortestTimeWhenEventsAreMany) {
  const PacketizerResult result =
      packetize(TestStream().imu(-10, 200, 1).events(0, 150, 0.1), Mode::Events);  // 35 events in 3.5 ms
  ASSERT_GE(result.packets.size(), 9U);
  for (std::size_t i = 1; i + 1 < result.packets.size(); ++i) {
    EXPECT_EQ(result.packets[i].t - result.packets[i - 1].t, duration_from_seconds(0.015));
    EXPECT_EQ(result.packets[i].events[0].new_events, 150U);
    EXPECT_EQ(result.packets[i].events[0].window().size(), kCut);
    EXPECT_LT(result.packets[i].t - result.packets[i].events[0].window().back().t, duration_from_seconds(1.001e-4));
  }
}

TEST(Packetizer, BeatsAtStandstillWithoutAnyEvent) {
  const PacketizerResult result = packetize(TestStream().imu(-10, 1000, 1).events(0, 0, 1), Mode::Events);
  ASSERT_GE(result.packets.size(), 20U);
  for (std::size_t i = 1; i < 20; ++i) {
    EXPECT_EQ(result.packets[i].t - result.packets[i - 1].t, duration_from_seconds(0.04));
    EXPECT_EQ(result.packets[i].events[0].new_events, 0U);
    EXPECT_EQ(result.packets[i].events[0].event_rate_hz, 0.0);
  }
  EXPECT_EQ(result.packets[3].events[0].window().size(), 1U);
  EXPECT_TRUE(result.packets[10].events[0].window().empty());  // the event is older than 0.25 s
}

TEST(Packetizer, OverlapsTheWindowOfThePacketBefore) {
  PacketizerConfig config;
  config.window_per_pixel = 1.0;
  const PacketizerResult result =
      packetize(TestStream().imu(-10, 400, 1).events(0, 350, 1), Mode::Events, make_rig(), config);
  ASSERT_GE(result.packets.size(), 8U);
  EXPECT_EQ(result.packets[0].events[0].events.size(), 35U);
  EXPECT_EQ(result.packets[1].events[0].events.size(), 70U);
  for (std::size_t i = 2; i < 8; ++i) {
    EXPECT_EQ(result.packets[i].events[0].events.size(), 100U);
    EXPECT_EQ(result.packets[i].events[0].window_events, 100U);
    EXPECT_EQ(result.packets[i].events[0].new_events, 35U);
    EXPECT_LE(result.packets[i].events[0].events.front().t, result.packets[i - 1].t);
  }
}

TEST(Packetizer, CutsAtEveryFrameWithTheEventsUpToItsStamp) {
  const PacketizerResult result =
      packetize(TestStream().imu(-10, 301, 1).events(0, 300, 2).frames(10, 300, 20), Mode::Fused);
  ASSERT_EQ(result.packets.size(), 15U);
  for (std::size_t i = 0; i < result.packets.size(); ++i) {
    const Packet& packet = result.packets[i];
    ASSERT_EQ(packet.frames.size(), 1U);
    EXPECT_EQ(packet.frames[0].t, packet.t);
    EXPECT_NEAR(to_ms(packet.t), 10.0 + 20.0 * static_cast<double>(i), 1e-6);
    EXPECT_EQ(packet.events[0].events.back().t, packet.t);  // the event at the frame's own stamp is included
    EXPECT_EQ(packet.events[0].new_events, i == 0 ? 6U : 10U);
  }
  EXPECT_EQ(result.counters.events_lost, 5U);  // after the last frame, 10 ms: too short for a packet
}

TEST(Packetizer, CutsBetweenFramesByCountButNotJustBeforeAFrame) {
  // Frames every 50 ms; 35 events every 17.5 ms: at 17.5 and 35 ms after a frame; the second is 15 ms before the next.
  PacketizerConfig config;
  config.min_interval_s = 0.016;
  const PacketizerResult result =
      packetize(TestStream().imu(-10, 501, 1).events(0, 500, 0.5).frames(0, 500, 50), Mode::Fused, make_rig(), config);
  int between = 0;
  for (std::size_t i = 4; i < result.packets.size(); ++i) {
    if (!result.packets[i].frames.empty()) continue;
    ++between;
    EXPECT_NEAR(std::fmod(to_ms(result.packets[i].t), 50.0), 17.5, 0.6);
  }
  EXPECT_GE(between, 8);
}

TEST(Packetizer, CutsWithoutAFrameThatFailsToCome) {
  const PacketizerResult result =
      packetize(TestStream().imu(-10, 501, 1).events(0, 500, 0.5).frames(0, 200, 50), Mode::Fused);
  double longest = 0.0;
  for (std::size_t i = 1; i < result.packets.size(); ++i) {
    longest = std::max(longest, to_seconds(result.packets[i].t - result.packets[i - 1].t));
  }
  EXPECT_LT(longest, 0.04);
  EXPECT_GT(to_ms(result.packets.back().t), 480.0);
}

TEST(Packetizer, CutsAtAFrameHoweverShortlyAfterAnEventPacket) {
  TestStream stream = TestStream().imu(-10, 100, 1).events(0, 60, 1);
  stream.frames(36, 36, 1);  // the count is reached at 34 ms; this frame was not expected
  const PacketizerResult result = packetize(stream, Mode::Fused);
  ASSERT_GE(result.packets.size(), 2U);
  EXPECT_TRUE(result.packets[0].frames.empty());
  ASSERT_EQ(result.packets[1].frames.size(), 1U);
  EXPECT_NEAR(to_ms(result.packets[1].t) - to_ms(result.packets[0].t), 2.0, 1e-6);
}

TEST(Packetizer, InFramesModeCutsOnlyAtFrames) {
  const PacketizerResult result =
      packetize(TestStream().imu(-10, 1000, 5).events(0, 900, 0.5).frames(0, 900, 100), Mode::Frames);
  ASSERT_EQ(result.packets.size(), 10U);
  for (const Packet& packet : result.packets) {
    EXPECT_EQ(packet.frames.size(), 1U);
    EXPECT_TRUE(packet.events.empty());
  }
}

TEST(Packetizer, InEventsModeIgnoresFrames) {
  const TestStream without = TestStream().imu(-10, 400, 1).events(0, 350, 1);
  const PacketizerResult with = packetize(TestStream(without).frames(0, 350, 13), Mode::Events);
  const PacketizerResult plain = packetize(without, Mode::Events);
  ASSERT_EQ(with.packets.size(), plain.packets.size());
  for (std::size_t i = 0; i < with.packets.size(); ++i) {
    EXPECT_TRUE(with.packets[i].frames.empty());
    EXPECT_EQ(with.packets[i].t, plain.packets[i].t);
  }
}

TEST(Packetizer, LosesNoEventAndKeepsTheOrder) {
  const TestStream stream = TestStream().imu(-10, 700, 1).events(0, 200, 0.05).events(200.5, 500, 4).frames(3, 600, 41);
  for (const Mode mode : {Mode::Events, Mode::Fused}) {
    const PacketizerResult result = packetize(stream, mode);
    EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 4001U + 75U);
    EXPECT_EQ(result.counters.events_late, 0U);
    Timestamp newest = ms_stamp(-1), last_cut = ms_stamp(-1);
    for (const Packet& packet : result.packets) {
      EXPECT_GT(packet.t, last_cut);
      last_cut = packet.t;
      const auto added = std::span<const Event>(packet.events[0].events).last(packet.events[0].new_events);
      for (const Event& event : added) {
        EXPECT_GT(event.t, newest);
        EXPECT_LE(event.t, packet.t);
        newest = event.t;
      }
    }
  }
}

TEST(Packetizer, DoesNotBeatThroughAHoleInTheRecording) {
  const PacketizerResult result = packetize(
      TestStream().imu(-10, 200, 1).events(0, 200, 1).imu(100000, 100200, 1).events(100000, 100200, 1), Mode::Events);
  EXPECT_LT(result.packets.size(), 16U);
  EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 402U);
}

TEST(Packetizer, GivesTheSamePacketsHoweverTheEventsAreBatched) {
  TestStream single = TestStream().imu(-10, 400, 10).events(0, 350, 0.5);
  TestStream batched = TestStream().imu(-10, 400, 10);
  for (double ms = 0; ms < 351; ms += 10) {
    EventBatch batch{"dvs", {}};
    for (double e = ms; e < std::min(ms + 9.9, 350.1); e += 0.5) batch.events.push_back({ms_stamp(e), 1, 2, true});
    batched.measurements.emplace_back(ms_stamp(ms), batch);
  }
  const PacketizerResult a = packetize(single, Mode::Events), b = packetize(batched, Mode::Events);
  ASSERT_EQ(a.packets.size(), b.packets.size());
  for (std::size_t i = 0; i < a.packets.size(); ++i) {
    EXPECT_EQ(a.packets[i].t, b.packets[i].t);
    EXPECT_EQ(a.packets[i].events[0].new_events, b.packets[i].events[0].new_events);
    EXPECT_EQ(a.packets[i].events[0].events.size(), b.packets[i].events[0].events.size());
  }
}

TEST(Packetizer, ExplainsContradictingIntervals) {
  PacketizerConfig config;
  config.min_interval_s = 0.1;
  EXPECT_THROW(Packetizer(make_rig(), config), InputError);
}

TEST(Packetizer, GivesNothingForAnEmptyRecording) {
  EXPECT_TRUE(packetize(TestStream(), Mode::Fused).packets.empty());
  EXPECT_TRUE(packetize(TestStream().imu(0, 100, 1), Mode::Fused).packets.empty());
  EXPECT_TRUE(packetize(TestStream().events(0, 100, 1).frames(0, 100, 10), Mode::Fused).packets.empty());
}

}  // namespace
}  // namespace edged

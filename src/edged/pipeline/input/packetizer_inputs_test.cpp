// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The inputs of the packetizer: IMU samples, time offsets, late and lost measurements, external samples.
#include <gtest/gtest.h>

#include <algorithm>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/pipeline/input/packetizer.hpp"
#include "edged/pipeline/input/packetizer_test_support.hpp"
#include "edged/pipeline/mode.hpp"

namespace edged {
namespace {

TEST(Packetizer, CoversEachPacketWithImuInterpolatedAtBothEnds) {
  const PacketizerResult result = packetize(TestStream().imu(-11.3, 400, 7).events(0, 350, 1), Mode::Events);
  ASSERT_GE(result.packets.size(), 9U);
  EXPECT_NEAR(to_ms(result.packets[0].imu.front().t), -11.3, 1e-6);
  for (std::size_t i = 0; i < result.packets.size(); ++i) {
    const std::vector<ImuSample>& imu = result.packets[i].imu;
    if (i > 0) {
      EXPECT_EQ(imu.front().t, result.packets[i - 1].t);
    }
    EXPECT_EQ(imu.back().t, result.packets[i].t);
    for (std::size_t k = 0; k < imu.size(); ++k) {
      EXPECT_NEAR(imu[k].gyro_B.x(), to_seconds(imu[k].t), 1e-9);
      if (k > 0) {
        EXPECT_LT(imu[k - 1].t, imu[k].t);
      }
    }
  }
}

TEST(Packetizer, GivesTwoInterpolatedEndsWhenTheImuIsSlowerThanThePackets) {
  const PacketizerResult result = packetize(TestStream().imu(-10, 500, 100).events(0, 350, 0.1), Mode::Events);
  ASSERT_GE(result.packets.size(), 20U);
  std::size_t bare = 0;
  for (const Packet& packet : result.packets) bare += packet.imu.size() == 2 ? 1 : 0;
  EXPECT_GE(bare, 15U);
}

TEST(Packetizer, StillDeliversAcrossAGapInTheImu) {
  const PacketizerResult result =
      packetize(TestStream().imu(-10, 100, 1).imu(300, 500, 1).events(0, 450, 1), Mode::Events);
  EXPECT_EQ(result.counters.packets_overflow, 0U);
  EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 451U);
  for (std::size_t i = 1; i < result.packets.size(); ++i) {
    EXPECT_LE(result.packets[i].t - result.packets[i - 1].t, duration_from_seconds(0.04));
  }
}

TEST(Packetizer, WaitsUntilTheImuPassesThePacket) {
  Packetizer packetizer(used_cameras(make_rig(), Mode::Frames), {});
  packetizer.add(imu_at(0));
  packetizer.add(Frame{ms_stamp(10), "cam", cv::Mat()});
  EXPECT_FALSE(packetizer.next().has_value());
  packetizer.add(imu_at(9));
  EXPECT_FALSE(packetizer.next().has_value());
  packetizer.add(imu_at(10));
  ASSERT_TRUE(packetizer.next().has_value());
  EXPECT_FALSE(packetizer.next().has_value());
}

TEST(Packetizer, AppliesTheTimeOffsetToEventsAndFramesAlike) {
  const TestStream stream = TestStream().imu(-10, 500, 1).events(0, 300, 1).frames(20, 300, 50);
  const PacketizerResult plain = packetize(stream, Mode::Fused);
  const PacketizerResult shifted = packetize(stream, Mode::Fused, make_rig(2.4, 2.4));
  ASSERT_EQ(plain.packets.size(), shifted.packets.size());
  const Duration offset = duration_from_seconds(2.4e-3);
  for (std::size_t i = 0; i < plain.packets.size(); ++i) {
    EXPECT_EQ(shifted.packets[i].t, plain.packets[i].t + offset);
    ASSERT_EQ(shifted.packets[i].events[0].events.size(), plain.packets[i].events[0].events.size());
    EXPECT_EQ(shifted.packets[i].events[0].events.back().t, plain.packets[i].events[0].events.back().t + offset);
    EXPECT_EQ(shifted.packets[i].frames.size(), plain.packets[i].frames.size());
  }
}

TEST(Packetizer, WaitsForEventsAndFramesWhoseOffsetsDiffer) {
  for (const auto& [event_offset, frame_offset] : {std::pair{5.0, 0.0}, {0.0, 5.0}, {-3.0, 4.0}, {4.0, -3.0}}) {
    const PacketizerResult result = packetize(TestStream().imu(-50, 500, 1).events(0, 300, 1).frames(20, 280, 30),
                                              Mode::Fused, make_rig(event_offset, frame_offset));
    EXPECT_EQ(result.counters.events_late, 0U);
    EXPECT_EQ(result.counters.frames_late, 0U);
    EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 301U);
    int frames = 0;
    for (const Packet& packet : result.packets) {
      if (packet.frames.empty()) continue;
      ++frames;
      ASSERT_FALSE(packet.events[0].events.empty());
      EXPECT_LE(packet.events[0].events.back().t, packet.t);
      EXPECT_LT(packet.t - packet.events[0].events.back().t, duration_from_seconds(1.001e-3));
    }
    EXPECT_EQ(frames, 9);
  }
}

TEST(Packetizer, DropsAndCountsPacketsOutsideTheImu) {
  const PacketizerResult result = packetize(TestStream().imu(100, 200, 1).events(0, 300, 1), Mode::Events);
  EXPECT_EQ(result.counters.packets_before_imu, 2U);  // 34 and 69 ms
  EXPECT_GT(result.counters.packets_after_imu, 0U);
  ASSERT_FALSE(result.packets.empty());
  EXPECT_NEAR(to_ms(result.packets.front().imu.front().t), 100.0, 1e-6);
  EXPECT_LE(to_ms(result.packets.back().t), 200.0);
  EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 301U);
  EXPECT_EQ(result.counters.packets, result.packets.size());
}

TEST(Packetizer, DropsAndCountsWhatComesOutOfOrder) {
  Packetizer packetizer(make_rig(), {});
  packetizer.add(imu_at(0));
  packetizer.add(EventBatch{"dvs", {{ms_stamp(5), 1, 1, true}, {ms_stamp(4), 1, 1, true}, {ms_stamp(6), 1, 1, true}}});
  packetizer.add(Frame{ms_stamp(10), "cam", cv::Mat()});
  packetizer.add(Frame{ms_stamp(10), "cam", cv::Mat()});
  packetizer.add(EventBatch{"dvs", {{ms_stamp(9), 1, 1, true}}});
  packetizer.add(EventBatch{"other", {{ms_stamp(11), 1, 1, true}}});
  packetizer.add(imu_at(20));
  packetizer.add(imu_at(15));
  const auto packet = packetizer.next();
  ASSERT_TRUE(packet.has_value());
  EXPECT_EQ(packet->events[0].new_events, 2U);
  EXPECT_EQ(packetizer.counters().events_late, 2U);
  EXPECT_EQ(packetizer.counters().frames_late, 1U);
  EXPECT_EQ(packetizer.counters().imu[ImuFault::Late], 1U);
}

TEST(Packetizer, KeepsItsMemoryBoundedWhenTheImuStaysAway) {
  PacketizerConfig config;
  config.max_waiting_events = 1000;
  const PacketizerResult result =
      packetize(TestStream().imu(-10, 0, 1).imu(5000, 5010, 1).events(0, 5000, 1), Mode::Events, make_rig(), config);
  EXPECT_GT(result.counters.packets_overflow, 100U);
  std::size_t kept = 0;
  for (const Packet& packet : result.packets) kept += packet.events[0].events.size();
  EXPECT_LE(kept, 1100U);
  EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 5001U);
  ASSERT_FALSE(result.packets.empty());
  EXPECT_LE(to_ms(result.packets.front().imu.front().t), 0.0);  // the motion since the last packet is still covered
}

TEST(Packetizer, KeepsTheFramesOfAGapOfTheImu) {
  PacketizerConfig config;
  config.max_waiting_events = 1000;
  const TestStream stream = TestStream().imu(-10, 0, 1).imu(5000, 5010, 1).events(0, 5000, 1).frames(20, 5000, 40);
  const PacketizerResult result = packetize(stream, Mode::Fused, make_rig(), config);
  std::size_t frames = 0, kept = 0;
  for (const Packet& packet : result.packets) {
    frames += packet.frames.size();
    kept += packet.events[0].events.size();
  }
  EXPECT_EQ(frames, 125U);
  EXPECT_LE(kept, 1100U);
  EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 5001U);
}

Measurement height_at_ms(double ms) { return ExternalSample(HeightSample{ms_stamp(ms), ms, 0.1}); }

TestStream with_heights(TestStream stream, double from, double to, double step) {
  for (double ms = from; ms <= to + 1e-9; ms += step) stream.measurements.emplace_back(ms_stamp(ms), height_at_ms(ms));
  return stream;
}

TEST(Packetizer, ExternalSamplesGoIntoThePacketOfTheirTimeAndChangeNoCut) {
  const TestStream stream = TestStream().imu(-10, 400, 1).events(0, 350, 1).frames(5, 350, 50);
  const PacketizerResult plain = packetize(stream, Mode::Fused),
                         with = packetize(with_heights(stream, -30, 400, 4), Mode::Fused);
  ASSERT_EQ(plain.packets.size(), with.packets.size());
  Timestamp from = plain.packets.front().imu.front().t;
  std::size_t taken = 0;
  for (std::size_t i = 0; i < plain.packets.size(); ++i) {
    const Packet& packet = with.packets[i];
    EXPECT_EQ(packet.t, plain.packets[i].t);
    EXPECT_EQ(packet.events[0].new_events, plain.packets[i].events[0].new_events);
    EXPECT_TRUE(plain.packets[i].external.empty());
    for (const ExternalSample& sample : packet.external) {
      EXPECT_GT(time_of(sample), from);
      EXPECT_LE(time_of(sample), packet.t);
    }
    EXPECT_TRUE(std::ranges::is_sorted(packet.external, {}, [](const ExternalSample& s) { return time_of(s); }));
    taken += packet.external.size();
    from = packet.t;
  }
  EXPECT_EQ(with.counters.external[0], taken);
  EXPECT_GT(with.counters.external_lost[0], 5U) << "before the IMU, and after the last packet";
  EXPECT_EQ(taken + with.counters.external_lost[0], 108U) << "every sample is counted once";
  EXPECT_EQ(with.counters.external_late, ExternalCounts{});
}

TEST(Packetizer, ALateExternalSampleIsUsedUntilItsPacketIsHandedOut) {
  Packetizer packetizer(used_cameras(make_rig(), Mode::Frames), kQuick);
  const auto add = [&](const Measurement& m) { packetizer.add(m); };
  add(imu_at(0));
  add(Frame{ms_stamp(10), "cam", cv::Mat()});
  add(Frame{ms_stamp(30), "cam", cv::Mat()});
  add(height_at_ms(12));
  add(height_at_ms(9));
  add(imu_at(20));
  const auto first = packetizer.next();
  ASSERT_TRUE(first);
  ASSERT_EQ(first->external.size(), 1U);
  EXPECT_EQ(time_of(first->external[0]), ms_stamp(9));
  add(height_at_ms(10));
  EXPECT_EQ(packetizer.counters().external_late[0], 1U);
  add(height_at_ms(11));
  add(imu_at(40));
  const auto second = packetizer.next();
  ASSERT_TRUE(second);
  ASSERT_EQ(second->external.size(), 2U);
  EXPECT_EQ(time_of(second->external[0]), ms_stamp(11));
  EXPECT_EQ(time_of(second->external[1]), ms_stamp(12));
}

}  // namespace
}  // namespace edged

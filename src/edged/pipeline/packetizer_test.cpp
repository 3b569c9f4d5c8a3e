// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Streams with known stamps through the packetizer. The camera has 100 pixels: 35 events make a packet.
#include "edged/pipeline/packetizer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "edged/core/check.hpp"
#include "edged/core/measurement_stamps.hpp"
#include "edged/pipeline/mode.hpp"

namespace edged {
namespace {

constexpr std::size_t kCut = 35;
Timestamp at_ms(double ms) { return timestamp_from_seconds(1e-3 * ms); }
ImuSample imu_at(double ms) {
  // Linear in time, so that interpolation can be checked.
  return {at_ms(ms), Eigen::Vector3d(ms, 0, 0), Eigen::Vector3d(0, 0, 9.81)};
}

double to_ms(Timestamp t) { return 1e3 * to_seconds(t); }

Rig make_rig(double event_offset_ms = 0.0, double frame_offset_ms = 0.0) {
  const CameraModel model(10, 10, 10, 10, 5, 5);
  return {"test",
          {{"dvs", Modality::Events, model, SE3(), duration_from_seconds(1e-3 * event_offset_ms)},
           {"cam", Modality::Frames, model, SE3(), duration_from_seconds(1e-3 * frame_offset_ms)}}};
}

/// A recording under construction; stamps in ms as recorded.
struct Stream {
  std::vector<std::pair<Timestamp, Measurement>> measurements;

  Stream& imu(double from, double to, double step) {
    for (double ms = from; ms <= to + 1e-9; ms += step) measurements.emplace_back(at_ms(ms), imu_at(ms));
    return *this;
  }
  Stream& events(double from, double to, double step) {
    for (double ms = from; ms <= to + 1e-9; ms += step) {
      measurements.emplace_back(at_ms(ms), EventBatch{"dvs", {{at_ms(ms), 1, 2, true}}});
    }
    return *this;
  }
  Stream& frames(double from, double to, double step) {
    for (double ms = from; ms <= to + 1e-9; ms += step) {
      measurements.emplace_back(at_ms(ms), Frame{at_ms(ms), "cam", cv::Mat()});
    }
    return *this;
  }
};

struct Result {
  std::vector<Packet> packets;
  PacketizerCounters counters;
};

constexpr PacketizerConfig kQuick{.min_interval_s = 0.015};  // little data for many packets
Result run(Stream stream, Mode mode, const Rig& rig = make_rig(), const PacketizerConfig& config = kQuick) {
  const auto rank = [](const Measurement& m) {
    return std::holds_alternative<ExternalSample>(m) ? -1
           : std::holds_alternative<ImuSample>(m)    ? 0
           : std::holds_alternative<EventBatch>(m)   ? 1
                                                     : 2;
  };
  std::stable_sort(stream.measurements.begin(), stream.measurements.end(), [&](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : rank(a.second) < rank(b.second);
  });
  Packetizer packetizer(used_cameras(rig, mode), config);
  Result result;
  const auto collect = [&] {
    while (auto packet = packetizer.next()) result.packets.push_back(std::move(*packet));
  };
  for (const auto& [t, measurement] : stream.measurements) {
    packetizer.add(measurement);
    collect();
  }
  packetizer.finish();
  collect();
  result.counters = packetizer.counters();
  return result;
}

std::size_t sum_of_new_events(const Result& result) {
  std::size_t sum = 0;
  for (const Packet& packet : result.packets) sum += packet.events[0].new_events;
  return sum;
}

TEST(Packetizer, CutsAfterAGivenNumberOfEvents) {
  // 1 event/ms with limits that do not bind: every 35 ms.
  const Result result = run(Stream().imu(-10, 400, 1).events(0, 350, 1), Mode::Events);
  ASSERT_GE(result.packets.size(), 9U);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(result.packets[i].events[0].new_events, kCut);
    EXPECT_EQ(result.packets[i].t, result.packets[i].events[0].events.back().t);
    EXPECT_NEAR(to_ms(result.packets[i].t), 34.0 + 35.0 * static_cast<double>(i), 1e-6);
    EXPECT_NEAR(result.packets[i].events[0].event_rate_hz, 1000.0, 30.0);
  }
}

TEST(Packetizer, CutsAfterTheLongestTimeWhenEventsAreFew) {
  const Result result = run(Stream().imu(-10, 500, 1).events(0, 450, 3), Mode::Events);
  ASSERT_GE(result.packets.size(), 10U);
  for (std::size_t i = 1; i < 10; ++i) {
    EXPECT_EQ(result.packets[i].t - result.packets[i - 1].t, duration_from_seconds(0.04));
  }
}

TEST(Packetizer, KeepsTheShortestTimeWhenEventsAreMany) {
  const Result result = run(Stream().imu(-10, 200, 1).events(0, 150, 0.1), Mode::Events);  // 35 events in 3.5 ms
  ASSERT_GE(result.packets.size(), 9U);
  for (std::size_t i = 1; i + 1 < result.packets.size(); ++i) {
    EXPECT_EQ(result.packets[i].t - result.packets[i - 1].t, duration_from_seconds(0.015));
    EXPECT_EQ(result.packets[i].events[0].new_events, 150U);
    EXPECT_EQ(result.packets[i].events[0].window().size(), kCut);
    EXPECT_LT(result.packets[i].t - result.packets[i].events[0].window().back().t, duration_from_seconds(1.001e-4));
  }
}

TEST(Packetizer, BeatsAtStandstillWithoutAnyEvent) {
  const Result result = run(Stream().imu(-10, 1000, 1).events(0, 0, 1), Mode::Events);
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
  const Result result = run(Stream().imu(-10, 400, 1).events(0, 350, 1), Mode::Events, make_rig(), config);
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
  const Result result = run(Stream().imu(-10, 301, 1).events(0, 300, 2).frames(10, 300, 20), Mode::Fused);
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
  const Result result =
      run(Stream().imu(-10, 501, 1).events(0, 500, 0.5).frames(0, 500, 50), Mode::Fused, make_rig(), config);
  int between = 0;
  for (std::size_t i = 4; i < result.packets.size(); ++i) {
    if (!result.packets[i].frames.empty()) continue;
    ++between;
    EXPECT_NEAR(std::fmod(to_ms(result.packets[i].t), 50.0), 17.5, 0.6);
  }
  EXPECT_GE(between, 8);
}

TEST(Packetizer, CutsWithoutAFrameThatFailsToCome) {
  const Result result = run(Stream().imu(-10, 501, 1).events(0, 500, 0.5).frames(0, 200, 50), Mode::Fused);
  double longest = 0.0;
  for (std::size_t i = 1; i < result.packets.size(); ++i) {
    longest = std::max(longest, to_seconds(result.packets[i].t - result.packets[i - 1].t));
  }
  EXPECT_LT(longest, 0.04);
  EXPECT_GT(to_ms(result.packets.back().t), 480.0);
}

TEST(Packetizer, CutsAtAFrameHoweverShortlyAfterAnEventPacket) {
  Stream stream = Stream().imu(-10, 100, 1).events(0, 60, 1);
  stream.frames(36, 36, 1);  // the count is reached at 34 ms; this frame was not expected
  const Result result = run(stream, Mode::Fused);
  ASSERT_GE(result.packets.size(), 2U);
  EXPECT_TRUE(result.packets[0].frames.empty());
  ASSERT_EQ(result.packets[1].frames.size(), 1U);
  EXPECT_NEAR(to_ms(result.packets[1].t) - to_ms(result.packets[0].t), 2.0, 1e-6);
}

TEST(Packetizer, InFramesModeCutsOnlyAtFrames) {
  const Result result = run(Stream().imu(-10, 1000, 5).events(0, 900, 0.5).frames(0, 900, 100), Mode::Frames);
  ASSERT_EQ(result.packets.size(), 10U);
  for (const Packet& packet : result.packets) {
    EXPECT_EQ(packet.frames.size(), 1U);
    EXPECT_TRUE(packet.events.empty());
  }
}

TEST(Packetizer, InEventsModeIgnoresFrames) {
  const Stream without = Stream().imu(-10, 400, 1).events(0, 350, 1);
  const Result with = run(Stream(without).frames(0, 350, 13), Mode::Events);
  const Result plain = run(without, Mode::Events);
  ASSERT_EQ(with.packets.size(), plain.packets.size());
  for (std::size_t i = 0; i < with.packets.size(); ++i) {
    EXPECT_TRUE(with.packets[i].frames.empty());
    EXPECT_EQ(with.packets[i].t, plain.packets[i].t);
  }
}

TEST(Packetizer, CoversEachPacketWithImuInterpolatedAtBothEnds) {
  const Result result = run(Stream().imu(-11.3, 400, 7).events(0, 350, 1), Mode::Events);
  ASSERT_GE(result.packets.size(), 9U);
  EXPECT_NEAR(to_ms(result.packets[0].imu.front().t), -11.3, 1e-6);
  for (std::size_t i = 0; i < result.packets.size(); ++i) {
    const std::vector<ImuSample>& imu = result.packets[i].imu;
    if (i > 0) {
      EXPECT_EQ(imu.front().t, result.packets[i - 1].t);
    }
    EXPECT_EQ(imu.back().t, result.packets[i].t);
    for (std::size_t k = 0; k < imu.size(); ++k) {
      EXPECT_NEAR(imu[k].gyro_B.x(), to_ms(imu[k].t), 1e-6);
      if (k > 0) {
        EXPECT_LT(imu[k - 1].t, imu[k].t);
      }
    }
  }
}

TEST(Packetizer, GivesTwoInterpolatedEndsWhenTheImuIsSlowerThanThePackets) {
  const Result result = run(Stream().imu(-10, 500, 100).events(0, 350, 0.1), Mode::Events);
  ASSERT_GE(result.packets.size(), 20U);
  std::size_t bare = 0;
  for (const Packet& packet : result.packets) bare += packet.imu.size() == 2 ? 1 : 0;
  EXPECT_GE(bare, 15U);
}

TEST(Packetizer, StillDeliversAcrossAGapInTheImu) {
  const Result result = run(Stream().imu(-10, 100, 1).imu(300, 500, 1).events(0, 450, 1), Mode::Events);
  EXPECT_EQ(result.counters.packets_overflow, 0U);
  EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 451U);
  for (std::size_t i = 1; i < result.packets.size(); ++i) {
    EXPECT_LE(result.packets[i].t - result.packets[i - 1].t, duration_from_seconds(0.04));
  }
}

TEST(Packetizer, WaitsUntilTheImuPassesThePacket) {
  Packetizer packetizer(used_cameras(make_rig(), Mode::Frames), {});
  packetizer.add(imu_at(0));
  packetizer.add(Frame{at_ms(10), "cam", cv::Mat()});
  EXPECT_FALSE(packetizer.next().has_value());
  packetizer.add(imu_at(9));
  EXPECT_FALSE(packetizer.next().has_value());
  packetizer.add(imu_at(10));
  ASSERT_TRUE(packetizer.next().has_value());
  EXPECT_FALSE(packetizer.next().has_value());
}

TEST(Packetizer, AppliesTheTimeOffsetToEventsAndFramesAlike) {
  const Stream stream = Stream().imu(-10, 500, 1).events(0, 300, 1).frames(20, 300, 50);
  const Result plain = run(stream, Mode::Fused);
  const Result shifted = run(stream, Mode::Fused, make_rig(2.4, 2.4));
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
    const Result result = run(Stream().imu(-50, 500, 1).events(0, 300, 1).frames(20, 280, 30), Mode::Fused,
                              make_rig(event_offset, frame_offset));
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
  const Result result = run(Stream().imu(100, 200, 1).events(0, 300, 1), Mode::Events);
  EXPECT_EQ(result.counters.packets_before_imu, 2U);  // 34 and 69 ms
  EXPECT_GT(result.counters.packets_after_imu, 0U);
  ASSERT_FALSE(result.packets.empty());
  EXPECT_NEAR(to_ms(result.packets.front().imu.front().t), 100.0, 1e-6);
  EXPECT_LE(to_ms(result.packets.back().t), 200.0);
  EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 301U);
  EXPECT_EQ(result.counters.packets, result.packets.size());
}

TEST(Packetizer, LosesNoEventAndKeepsTheOrder) {
  const Stream stream = Stream().imu(-10, 700, 1).events(0, 200, 0.05).events(200.5, 500, 4).frames(3, 600, 41);
  for (const Mode mode : {Mode::Events, Mode::Fused}) {
    const Result result = run(stream, mode);
    EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 4001U + 75U);
    EXPECT_EQ(result.counters.events_late, 0U);
    Timestamp newest = at_ms(-1), last_cut = at_ms(-1);
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

TEST(Packetizer, DropsAndCountsWhatComesOutOfOrder) {
  Packetizer packetizer(make_rig(), {});
  packetizer.add(imu_at(0));
  packetizer.add(EventBatch{"dvs", {{at_ms(5), 1, 1, true}, {at_ms(4), 1, 1, true}, {at_ms(6), 1, 1, true}}});
  packetizer.add(Frame{at_ms(10), "cam", cv::Mat()});
  packetizer.add(Frame{at_ms(10), "cam", cv::Mat()});
  packetizer.add(EventBatch{"dvs", {{at_ms(9), 1, 1, true}}});
  packetizer.add(EventBatch{"other", {{at_ms(11), 1, 1, true}}});
  packetizer.add(imu_at(20));
  packetizer.add(imu_at(15));
  const auto packet = packetizer.next();
  ASSERT_TRUE(packet.has_value());
  EXPECT_EQ(packet->events[0].new_events, 2U);
  EXPECT_EQ(packetizer.counters().events_late, 2U);
  EXPECT_EQ(packetizer.counters().frames_late, 1U);
  EXPECT_EQ(packetizer.counters().imu_late, 1U);
}

TEST(Packetizer, KeepsItsMemoryBoundedWhenTheImuStaysAway) {
  PacketizerConfig config;
  config.max_waiting_events = 1000;
  const Result result =
      run(Stream().imu(-10, 0, 1).imu(5000, 5010, 1).events(0, 5000, 1), Mode::Events, make_rig(), config);
  EXPECT_GT(result.counters.packets_overflow, 100U);
  std::size_t kept = 0;
  for (const Packet& packet : result.packets) kept += packet.events[0].events.size();
  EXPECT_LE(kept, 1100U);
  EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 5001U);
  ASSERT_FALSE(result.packets.empty());
  EXPECT_LE(to_ms(result.packets.front().imu.front().t), 0.0);  // the motion since the last packet is still covered
}

TEST(Packetizer, DoesNotBeatThroughAHoleInTheRecording) {
  const Result result =
      run(Stream().imu(-10, 200, 1).events(0, 200, 1).imu(100000, 100200, 1).events(100000, 100200, 1), Mode::Events);
  EXPECT_LT(result.packets.size(), 16U);
  EXPECT_EQ(sum_of_new_events(result) + result.counters.events_lost, 402U);
}

TEST(Packetizer, GivesTheSamePacketsHoweverTheEventsAreBatched) {
  Stream single = Stream().imu(-10, 400, 10).events(0, 350, 0.5);
  Stream batched = Stream().imu(-10, 400, 10);
  for (double ms = 0; ms < 351; ms += 10) {
    EventBatch batch{"dvs", {}};
    for (double e = ms; e < std::min(ms + 9.9, 350.1); e += 0.5) batch.events.push_back({at_ms(e), 1, 2, true});
    batched.measurements.emplace_back(at_ms(ms), batch);
  }
  const Result a = run(single, Mode::Events), b = run(batched, Mode::Events);
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
  EXPECT_TRUE(run(Stream(), Mode::Fused).packets.empty());
  EXPECT_TRUE(run(Stream().imu(0, 100, 1), Mode::Fused).packets.empty());
  EXPECT_TRUE(run(Stream().events(0, 100, 1).frames(0, 100, 10), Mode::Fused).packets.empty());
}

Measurement height_at(double ms) { return ExternalSample(HeightSample{at_ms(ms), ms, 0.1}); }

Stream with_heights(Stream stream, double from, double to, double step) {
  for (double ms = from; ms <= to + 1e-9; ms += step) stream.measurements.emplace_back(at_ms(ms), height_at(ms));
  return stream;
}

TEST(Packetizer, ExternalSamplesGoIntoThePacketOfTheirTimeAndChangeNoCut) {
  const Stream stream = Stream().imu(-10, 400, 1).events(0, 350, 1).frames(5, 350, 50);
  const Result plain = run(stream, Mode::Fused), with = run(with_heights(stream, -30, 400, 4), Mode::Fused);
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
  add(Frame{at_ms(10), "cam", cv::Mat()});
  add(Frame{at_ms(30), "cam", cv::Mat()});
  add(height_at(12));
  add(height_at(9));
  add(imu_at(20));
  const auto first = packetizer.next();
  ASSERT_TRUE(first);
  ASSERT_EQ(first->external.size(), 1U);
  EXPECT_EQ(time_of(first->external[0]), at_ms(9));
  add(height_at(10));
  EXPECT_EQ(packetizer.counters().external_late[0], 1U);
  add(height_at(11));
  add(imu_at(40));
  const auto second = packetizer.next();
  ASSERT_TRUE(second);
  ASSERT_EQ(second->external.size(), 2U);
  EXPECT_EQ(time_of(second->external[0]), at_ms(11));
  EXPECT_EQ(time_of(second->external[1]), at_ms(12));
}

}  // namespace
}  // namespace edged

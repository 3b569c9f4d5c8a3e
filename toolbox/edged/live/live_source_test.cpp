// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/live_source.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/live/test_storm.hpp"

namespace edged {
namespace {

const auto kNotInterrupted = [] { return false; };
const QueueConfig kRoomy{.max_age_s = 3600, .max_megabytes = 4096, .max_imu_samples = 1'000'000};

EventStorm breeze(int duration_ms) { return {"dvs", "camera", {64, 48}, 1e5, duration_ms}; }

struct Counts {
  std::size_t events = 0, frames = 0, imu = 0;
};

Counts count_all(LiveSource& source) {
  Counts counts;
  while (const auto m = source.next()) {
    if (const auto* batch = std::get_if<EventBatch>(&*m)) counts.events += batch->events.size();
    counts.frames += std::holds_alternative<Frame>(*m) ? 1 : 0;
    counts.imu += std::holds_alternative<ImuSample>(*m) ? 1 : 0;
    source.note_result(*last_stamp(*m));
  }
  return counts;
}

TEST(LiveSource, GivesAllOfARecordingAtItsOwnSpeed) {
  EventStorm storm = breeze(100);
  LiveSource source(storm, kRoomy, kNotInterrupted);
  const auto begin = std::chrono::steady_clock::now();
  const Counts counts = count_all(source);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(90));
  EXPECT_EQ(counts.events, storm.events());
  EXPECT_EQ(counts.frames, storm.frames());
  EXPECT_EQ(counts.imu, storm.imu_samples());
  EXPECT_EQ(source.dropped(), DropCounters{});
  EXPECT_EQ(source.latency().count(), 2 * storm.imu_samples() + storm.frames());
  EXPECT_GE(source.latency().max_s(), 0.0);
}

TEST(LiveSource, ReportsEachMeasurementWhenItIsDueEvenIfNobodyTakesIt) {
  EventStorm storm = breeze(100);
  std::atomic<std::size_t> imu = 0;
  LiveSource source(storm, kRoomy, kNotInterrupted,
                    [&imu](const Measurement& m) { imu += std::holds_alternative<ImuSample>(m) ? 1 : 0; });
  while (imu < storm.imu_samples()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(count_all(source).imu, storm.imu_samples());
}

TEST(LiveSource, WhoIsTooSlowMissesTheOldestEventsAndNoImuSample) {
  EventStorm storm = breeze(300);
  LiveSource source(storm, {.max_age_s = 0.05}, kNotInterrupted);
  while (source.peaks().imu < storm.imu_samples()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const Counts counts = count_all(source);
  EXPECT_GT(source.dropped().events, storm.events() / 2);
  EXPECT_GT(source.dropped().frames, 0U);
  EXPECT_EQ(counts.events + source.dropped().events, storm.events());
  EXPECT_EQ(counts.frames + source.dropped().frames, storm.frames());
  EXPECT_EQ(counts.imu, storm.imu_samples());
  EXPECT_LE(source.peaks().age_s, 0.1);
}

TEST(LiveSource, WhoHaltsMissesSomeOfTheLaterEventsAndFindsNoGap) {
  EventStorm storm = breeze(400);
  LiveSource source(storm, {.max_age_s = 2.0}, kNotInterrupted);
  while (source.peaks().imu < storm.imu_samples()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::size_t kept = 0;
  Timestamp before = Timestamp();
  while (const auto m = source.next()) {
    const auto* batch = std::get_if<EventBatch>(&*m);
    if (batch == nullptr) continue;
    kept += batch->events.size();
    for (const Event& event : batch->events) {
      EXPECT_LT(event.t - before, std::chrono::milliseconds(5));
      before = event.t;
    }
  }
  EXPECT_GT(source.dropped().events, storm.events() / 10);
  EXPECT_EQ(kept + source.dropped().events, storm.events());
  EXPECT_EQ(source.dropped().frames, 0U);
}

TEST(LiveSource, WhatIsReadTooSlowlyIsSkippedEvenlyButForFramesAndImuSamples) {
  const EventStorm storm = breeze(1000);
  SlowStorm slow(storm, 4);
  LiveSource source(slow, {}, kNotInterrupted);
  const Counts counts = count_all(source);
  source.stop();
  const DropCounters dropped = source.dropped();
  EXPECT_GT(dropped.unread, storm.events() / 2);
  // The last ones may be skipped after the last that is read.
  EXPECT_EQ(counts.events + dropped.events - dropped.unread + slow.skip_events(0.0), storm.events());
  EXPECT_EQ(counts.frames, storm.frames());
  EXPECT_EQ(counts.imu, storm.imu_samples());
}

TEST(LiveSource, AnErrorOfTheRecordingComesAfterAllThatCameBeforeIt) {
  BrokenStorm broken(breeze(20), "imu.txt:7: rubbish");
  LiveSource source(broken, kRoomy, kNotInterrupted);
  std::size_t imu = 0;
  EXPECT_THROW(
      {
        while (const auto m = source.next()) imu += std::holds_alternative<ImuSample>(*m) ? 1 : 0;
      },
      InputError);
  EXPECT_EQ(imu, breeze(20).imu_samples());
  EXPECT_FALSE(source.next());
}

TEST(LiveSource, EndsWhenTheUserInterruptsOrNobodyWantsMore) {
  EventStorm hour = breeze(3'600'000), other_hour = breeze(3'600'000);
  std::atomic<bool> interrupted = false;
  LiveSource source(hour, {}, [&interrupted] { return interrupted.load(); });
  EXPECT_TRUE(source.next());
  interrupted = true;
  while (source.next()) {
  }
  LiveSource unwanted(other_hour, {}, kNotInterrupted);
  EXPECT_TRUE(unwanted.next());
  unwanted.stop();
  EXPECT_FALSE(unwanted.next());
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/read_ahead.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <tuple>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/live/test_storm.hpp"

namespace edged {
namespace {

constexpr QueueConfig kNarrow{.max_megabytes = 1};  // 65536 events
const auto kNobodyInterrupts = [] { return false; };

/// Two megabytes of events in 100 ms, and frames.
EventStorm gust(int duration_ms = 100) { return {"dvs", "camera", {64, 48}, 1.3e6, duration_ms}; }

/// Kind, stamp and size of a measurement.
using Outline = std::tuple<std::size_t, Timestamp, std::size_t>;

Outline outline(const Measurement& measurement) {
  const auto* batch = std::get_if<EventBatch>(&measurement);
  return {measurement.index(), *last_stamp(measurement), batch ? batch->events.size() : 0};
}

template <typename Source>
std::vector<Outline> read_all(Source& source, std::chrono::microseconds pause = {}) {
  std::vector<Outline> all;
  while (const std::optional<Measurement> measurement = source.next()) {
    all.push_back(outline(*measurement));
    std::this_thread::sleep_for(pause);
  }
  return all;
}

TEST(ReadAhead, GivesTheSameInTheSameOrderWhoeverIsSlower) {
  EventStorm plain = gust();
  const std::vector<Outline> all = read_all(plain);
  for (const auto pause : {std::chrono::microseconds(0), std::chrono::microseconds(200)}) {
    EventStorm storm = gust(), slow = gust();
    ReadAhead reader(storm, kNarrow, WhenFull::Wait, kNobodyInterrupts);
    EXPECT_EQ(read_all(reader, pause), all);
    ReadAhead held(slow, kNarrow, WhenFull::Wait, kNobodyInterrupts, [&](const Measurement&, const auto&) {
      std::this_thread::sleep_for(pause);
      return MeasurementQueue::Clock::now();
    });
    EXPECT_EQ(read_all(held), all);
    EXPECT_EQ(held.queue().dropped(), DropCounters{});
  }
}

TEST(ReadAhead, WaitsForWhoIsSlowWithNoMoreThanIsAllowed) {
  EventStorm storm = gust();
  ReadAhead reader(storm, kNarrow, WhenFull::Wait, kNobodyInterrupts);
  constexpr std::size_t kAllowed = 1U << 20U, kBatch = 1300 * sizeof(Event);
  while (reader.queue().peaks().bytes < kAllowed) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_LT(reader.queue().peaks().bytes, kAllowed + kBatch);
  const std::size_t count = read_all(reader).size();
  reader.stop();
  EXPECT_EQ(count, 2 * storm.imu_samples() + storm.frames());
  EXPECT_LT(reader.queue().peaks().bytes, kAllowed + kBatch);
  EXPECT_EQ(reader.reading().count(), count + 1) << "the last call found the end";
  EXPECT_GT(reader.reading().cpu_s().value_or(0.0), 0.0);
}

TEST(ReadAhead, AnErrorOfTheRecordingComesOnceAfterAllThatCameBefore) {
  BrokenStorm torn(gust(20), "events.raw: cut in the middle");
  ReadAhead reader(torn, kNarrow, WhenFull::Wait, kNobodyInterrupts);
  std::size_t count = 0;
  try {
    while (reader.next()) ++count;
    ADD_FAILURE() << "no error";
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(), "events.raw: cut in the middle");
  }
  EventStorm whole = gust(20);
  EXPECT_EQ(count, read_all(whole).size());
  EXPECT_FALSE(reader.next());
}

TEST(ReadAhead, EndsWhenTheUserInterruptsOrNobodyWantsMoreAlsoWhileItWaitsForRoom) {
  EventStorm hour = gust(3'600'000), other_hour = gust(3'600'000), third_hour = gust(3'600'000);
  std::atomic<bool> interrupted = false;
  ReadAhead reader(hour, kNarrow, WhenFull::Wait, [&interrupted] { return interrupted.load(); });
  EXPECT_TRUE(reader.next());
  interrupted = true;
  while (reader.next()) {
  }
  ReadAhead unwanted(other_hour, kNarrow, WhenFull::Wait, kNobodyInterrupts);
  EXPECT_TRUE(unwanted.next());
  while (unwanted.queue().peaks().bytes < (1U << 20U)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  unwanted.stop();
  EXPECT_FALSE(unwanted.next());
  const ReadAhead forgotten(third_hour, kNarrow, WhenFull::Wait, kNobodyInterrupts);
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/measurement_queue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <random>
#include <thread>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

using testing::ElementsAre;

constexpr std::size_t kFrameBytes = 256 * 256;

Timestamp queue_ms(int ms) { return Timestamp() + std::chrono::milliseconds(ms); }

ImuSample imu_at(int ms) { return {queue_ms(ms), {}, {}}; }
Frame frame_at(int ms) { return {queue_ms(ms), "camera", cv::Mat(256, 256, CV_8UC1)}; }

/// n events that end at the given time, a microsecond apart.
EventBatch events_until(int ms, int n) {
  EventBatch batch{"dvs", {}};
  for (int i = n - 1; i >= 0; --i) batch.events.push_back({queue_ms(ms) - std::chrono::microseconds(i), 0, 0, true});
  return batch;
}

/// Measurements are due at their stamps.
class StampedQueue : public MeasurementQueue {
 public:
  using MeasurementQueue::MeasurementQueue;
  bool push(Measurement measurement) {
    const Clock::time_point due(last_stamp(measurement).value_or(Timestamp()).time_since_epoch());
    return MeasurementQueue::push(std::move(measurement), due);
  }
};

/// What is popped, in words: "imu 3", "frame 5", "4 events 7".
std::vector<std::string> drain(MeasurementQueue& queue) {
  queue.close();
  std::vector<std::string> popped;
  while (const auto m = queue.pop()) {
    const std::string ms = std::to_string((*last_stamp(*m) - Timestamp()) / std::chrono::milliseconds(1));
    const auto* batch = std::get_if<EventBatch>(&*m);
    const std::string kind = batch != nullptr                    ? std::to_string(batch->events.size()) + " events "
                             : std::holds_alternative<Frame>(*m) ? "frame "
                                                                 : "imu ";
    popped.push_back(kind + ms);
  }
  return popped;
}

TEST(MeasurementQueue, KeepsTheOrderOfWhatIsPushed) {
  StampedQueue queue(QueueConfig{});
  queue.push(imu_at(1));
  queue.push(events_until(2, 3));
  queue.push(imu_at(2));
  queue.push(frame_at(2));
  queue.push(EventBatch{"dvs", {}});
  queue.push(events_until(4, 2));
  EXPECT_THAT(drain(queue), ElementsAre("imu 1", "3 events 2", "imu 2", "frame 2", "2 events 4"));
  EXPECT_EQ(queue.dropped(), DropCounters{});
}

TEST(MeasurementQueue, DropsEventsThatHaveWaitedTooLongAndFramesAtTwiceThatButNeverTheImu) {
  StampedQueue queue({.max_age_s = 0.1});
  for (const int ms : {0, 60, 120, 180, 240}) {
    queue.push(imu_at(ms));
    queue.push(events_until(ms + 1, 10));
    queue.push(frame_at(ms + 2));
  }
  EXPECT_EQ(queue.dropped(), (DropCounters{30, 1}));
  EXPECT_THAT(drain(queue), ElementsAre("imu 0", "imu 60", "frame 62", "imu 120", "frame 122", "imu 180",
                                        "10 events 181", "frame 182", "imu 240", "10 events 241", "frame 242"));
}

TEST(MeasurementQueue, DropsTheOldestEventsOneByOneWhenThereAreTooMany) {
  StampedQueue queue({.max_age_s = 3600, .max_megabytes = 1});
  const int all = static_cast<int>((1U << 20U) / sizeof(Event));
  queue.push(events_until(100, all - 10));
  queue.push(imu_at(100));
  queue.push(events_until(200, 15));
  EXPECT_EQ(queue.dropped(), (DropCounters{5, 0}));
  queue.push(events_until(300, all));
  EXPECT_EQ(queue.dropped(), (DropCounters{static_cast<std::size_t>(all) + 5, 0}));
  EXPECT_THAT(drain(queue), ElementsAre("imu 100", std::to_string(all) + " events 300"));
}

TEST(MeasurementQueue, DropsFramesOnlyWhenNoEventIsLeft) {
  StampedQueue queue({.max_age_s = 3600, .max_megabytes = 1});
  const std::size_t room = (1U << 20U) / kFrameBytes;
  queue.push(events_until(0, 100));
  for (std::size_t i = 1; i < room; ++i) queue.push(frame_at(static_cast<int>(i)));
  EXPECT_EQ(queue.dropped(), DropCounters{});
  queue.push(frame_at(50));
  EXPECT_EQ(queue.dropped(), (DropCounters{100, 0}));
  queue.push(frame_at(51));
  EXPECT_EQ(queue.dropped(), (DropCounters{100, 1}));
}

TEST(MeasurementQueue, WaitsNoLongerForAMeasurementThanAskedTo) {
  StampedQueue queue(QueueConfig{});
  EXPECT_FALSE(queue.waits_since());
  EXPECT_FALSE(queue.pop(std::chrono::milliseconds(1)));
  queue.push(imu_at(7));
  EXPECT_EQ(queue.waits_since()->time_since_epoch(), std::chrono::milliseconds(7));
  EXPECT_TRUE(queue.pop(std::chrono::seconds(60)));
}

TEST(MeasurementQueue, CountsTheMostThatHasWaited) {
  StampedQueue queue(QueueConfig{});
  queue.push(events_until(10, 7));
  queue.push(frame_at(20));
  queue.push(imu_at(30));
  queue.push(imu_at(40));
  while (queue.peaks().imu < 2 || queue.pop()->index() != 2) {
  }
  queue.push(events_until(45, 2));
  const QueuePeaks peaks = queue.peaks();
  EXPECT_EQ(peaks.events, 7U);
  EXPECT_EQ(peaks.frames, 1U);
  EXPECT_EQ(peaks.imu, 2U);
  EXPECT_EQ(peaks.bytes, 7 * sizeof(Event) + kFrameBytes);
  EXPECT_NEAR(peaks.age_s, 0.030, 1e-4);
}

TEST(MeasurementQueue, WaitsWithTooManyImuSamplesInsteadOfLosingOne) {
  StampedQueue queue({.max_imu_samples = 1000});
  for (int i = 0; i < 1000; ++i) queue.push(imu_at(i));
  auto pushed = std::async(std::launch::async, [&queue] { return queue.push(imu_at(1000)); });
  for (int i = 0; i < 1001; ++i) EXPECT_EQ(last_stamp(*queue.pop()), queue_ms(i));
  EXPECT_TRUE(pushed.get());
}

TEST(MeasurementQueue, ThatWaitsDropsNothingHoweverOldAndGoesOnWhenHalfIsGone) {
  StampedQueue queue({.max_age_s = 0.001, .max_megabytes = 1}, WhenFull::Wait);
  const int half = static_cast<int>((1U << 19U) / sizeof(Event));
  queue.push(events_until(100, half));
  queue.push(frame_at(200));
  queue.push(events_until(10'000, half));
  auto pushed = std::async(std::launch::async, [&queue] { return queue.push(imu_at(10'001)); });
  EXPECT_EQ(pushed.wait_for(std::chrono::milliseconds(20)), std::future_status::timeout) << "the queue is full";
  EXPECT_EQ(last_stamp(*queue.pop()), queue_ms(100));
  EXPECT_EQ(last_stamp(*queue.pop()), queue_ms(200));
  EXPECT_TRUE(pushed.get());
  EXPECT_EQ(queue.dropped(), DropCounters{});
  EXPECT_THAT(drain(queue), ElementsAre(std::to_string(half) + " events 10000", "imu 10001"));
}

TEST(MeasurementQueue, AnInterruptWakesBothSides) {
  StampedQueue full({.max_imu_samples = 1000}), empty(QueueConfig{});
  for (int i = 0; i < 1000; ++i) full.push(imu_at(i));
  auto pushed = std::async(std::launch::async, [&full] { return full.push(imu_at(1000)); });
  auto popped = std::async(std::launch::async, [&empty] { return empty.pop(); });
  full.interrupt();
  empty.interrupt();
  EXPECT_FALSE(pushed.get());
  EXPECT_FALSE(popped.get());
  EXPECT_FALSE(full.pop()) << "queued measurements are dropped";
  EXPECT_FALSE(empty.push(imu_at(1)));
}

TEST(MeasurementQueue, ACloseWakesWhoWaitsAndKeepsWhatIsThere) {
  StampedQueue queue(QueueConfig{});
  auto popped = std::async(std::launch::async, [&queue] {
    int n = 0;
    while (queue.pop()) ++n;
    return n;
  });
  queue.push(imu_at(1));
  queue.push(frame_at(1));
  queue.close();
  EXPECT_FALSE(queue.push(imu_at(2)));
  EXPECT_EQ(popped.get(), 2);
}

TEST(MeasurementQueue, BetweenTwoThreadsWhatIsPoppedAndWhatIsDroppedIsAllThatWasPushed) {
  StampedQueue queue({.max_age_s = 0.02, .max_megabytes = 1});
  constexpr int kRounds = 3000;
  std::jthread sensors([&queue] {
    std::mt19937 random(5);
    for (int i = 0; i < kRounds; ++i) {
      queue.push(imu_at(i));
      queue.push(events_until(i, static_cast<int>(random() % 200 + 1)));
      if (i % 10 == 0) queue.push(frame_at(i));
    }
    queue.close();
  });
  std::size_t events = 0, frames = 0, imu = 0;
  Timestamp before = Timestamp::min();
  while (const auto m = queue.pop()) {
    EXPECT_GE(*last_stamp(*m), before);
    before = *last_stamp(*m);
    if (const auto* batch = std::get_if<EventBatch>(&*m)) events += batch->events.size();
    frames += std::holds_alternative<Frame>(*m) ? 1 : 0;
    imu += std::holds_alternative<ImuSample>(*m) ? 1 : 0;
  }
  std::mt19937 random(5);
  std::size_t pushed = 0;
  for (int i = 0; i < kRounds; ++i) pushed += random() % 200 + 1;
  EXPECT_EQ(events + queue.dropped().events, pushed);
  EXPECT_EQ(frames + queue.dropped().frames, static_cast<std::size_t>(kRounds / 10));
  EXPECT_EQ(imu, static_cast<std::size_t>(kRounds));
}

}  // namespace
}  // namespace edged

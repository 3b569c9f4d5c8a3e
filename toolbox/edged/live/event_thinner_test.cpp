// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/event_thinner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <utility>

namespace edged {
namespace {

/// Random pixels and polarities, 1 us apart.
std::vector<Event> flood(std::size_t count, cv::Size size) {
  std::mt19937 random(3);
  std::vector<Event> events(count);
  for (std::size_t i = 0; i < count; ++i) {
    events[i].t = Timestamp() + std::chrono::microseconds(i);
    events[i].x = static_cast<std::uint16_t>(random() % static_cast<unsigned>(size.width));
    events[i].y = static_cast<std::uint16_t>(random() % static_cast<unsigned>(size.height));
    events[i].positive = random() % 3 == 0;
  }
  return events;
}

bool is_same(const Event& a, const Event& b) {
  return a.t == b.t && a.x == b.x && a.y == b.y && a.positive == b.positive;
}

TEST(EventThinner, KeepsTheShareOfEachBlockAndPolarityInOrder) {
  const cv::Size size(64, 48);
  for (const double share : {0.9, 0.5, 0.2}) {
    const std::vector<Event> all = flood(200'000, size);
    std::vector<Event> some = all;
    EventThinner thinner;
    const std::size_t dropped = thinner.thin(some, share);
    EXPECT_EQ(some.size() + dropped, all.size());
    using Block = std::array<int, 3>;
    const auto block_of = [](const Event& e) { return Block{e.x / 8, e.y / 8, e.positive ? 1 : 0}; };
    std::map<Block, double> wanted;
    for (const Event& event : all) wanted[block_of(event)] += share;
    for (const Event& event : some) wanted[block_of(event)] -= 1.0;
    for (const auto& [block, off] : wanted) EXPECT_LT(std::abs(off), 1.1) << block[0] << " " << block[1];
    for (std::size_t i = 1; i < some.size(); ++i) EXPECT_LT(some[i - 1].t, some[i].t);
  }
}

TEST(EventThinner, SpreadsTheKeptEventsOverTime) {
  std::vector<Event> some = flood(100'000, {64, 48});
  EventThinner().thin(some, 0.1);
  std::array<int, 10> tenths{};
  for (const Event& event : some)
    ++tenths.at(static_cast<std::size_t>(event.t.time_since_epoch().count() / 10'000'000));
  for (const int count : tenths) EXPECT_NEAR(count, 1000, 100);
}

TEST(EventThinner, KeepsTheSameWhateverTheBatches) {
  std::vector<Event> whole = flood(10'000, {1280, 720}), parts;
  EventThinner once, often;
  for (std::size_t i = 0; i < whole.size(); i += 100) {
    std::vector<Event> part(whole.begin() + static_cast<std::ptrdiff_t>(i),
                            whole.begin() + static_cast<std::ptrdiff_t>(i) + 100);
    often.thin(part, 0.3);
    parts.insert(parts.end(), part.begin(), part.end());
  }
  once.thin(whole, 0.3);
  EXPECT_TRUE(std::equal(whole.begin(), whole.end(), parts.begin(), parts.end(), is_same));
}

TEST(EventThinner, KeepsAllOrNothingOfAnySensor) {
  std::vector<Event> events = flood(1000, {65536, 65536});
  EventThinner thinner;
  EXPECT_EQ(thinner.thin(events, 1.0), 0U);
  EXPECT_EQ(events.size(), 1000U);
  EXPECT_EQ(thinner.thin(events, 0.0), 1000U);
  EXPECT_EQ(thinner.thin(events, 0.5), 0U);
}

/// A consumer of events that come at `load` times the rate that it can process; its delay, 20 ms being free.
struct Consumer {
  void run(double load, double duration_s) {
    constexpr double kBatch_s = 1e-3, kFree_s = 0.02;
    for (double t = 0.0; t < duration_s; t += kBatch_s) {
      share = overload.next(delay, kBatch_s);
      delay = std::max(0.0, delay + (share * load - 1.0) * kBatch_s / kFree_s);
      longest = std::max(longest, delay);
    }
  }

  OverloadShare overload;
  double delay = 0.0, share = 1.0, longest = 0.0;
};

TEST(OverloadShare, ADelayThatIsFreeCostsNoEvent) {
  OverloadShare overload;
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(overload.next(0.99, 1e-3), 1.0);
}

TEST(OverloadShare, TheDelayReturnsToTheFreeOneWhileOverloadLasts) {
  for (const double load : {1.5, 3.0, 6.0}) {
    Consumer consumer;
    consumer.run(load, 2.0);
    EXPECT_NEAR(consumer.delay, 1.0, 0.1) << load;
    EXPECT_NEAR(consumer.share, 1.0 / load, 0.1 / load) << load;
    EXPECT_LT(consumer.longest, load) << load;  // it was where the share followed the delay alone
  }
}

TEST(OverloadShare, AllEventsAreKeptSoonAfterOverload) {
  Consumer consumer;
  consumer.run(4.0, 2.0);
  consumer.run(0.2, 0.5);
  EXPECT_EQ(consumer.share, 1.0);
}

/// A reader that takes `load` times as long for blocks of events as they span; its delay, 20 ms being free.
struct Reader {
  void run(double load, double duration_s) {
    constexpr double kBlock_s = 1e-3, kFree_s = 0.02;
    double now_s = 0.0, due = 0.0, passed_s = 0.0;
    for (double t_s = 0.0; t_s < duration_s; t_s += kBlock_s) {
      passed_s += kBlock_s;
      if ((due += share) < 1.0) continue;
      due -= 1.0;
      now_s = std::max(now_s, t_s) + load * kBlock_s;
      longest_s = std::max(longest_s, now_s - t_s);
      share = overload.next((now_s - t_s) / kFree_s, std::exchange(passed_s, 0.0), 0.01);
      read_s += kBlock_s;
    }
  }

  OverloadShare overload;
  double share = 1.0, longest_s = 0.0, read_s = 0.0;
};

TEST(OverloadShare, ASlowReaderSkipsSoMuchThatItIsNeverFarBehind) {
  for (const double load : {1.5, 3.0, 10.0}) {
    Reader reader;
    reader.run(load, 4.0);
    EXPECT_LT(reader.longest_s, 0.1) << load;
    EXPECT_NEAR(reader.read_s, 4.0 / load, 0.1 * 4.0 / load) << load << ": no more than has to be";
  }
}

TEST(OverloadThinner, ThinsTheEventsOfEachCameraAndCountsThem) {
  OverloadThinner thinner(0.25);
  const auto batch_of = [](const char* camera) {
    EventBatch batch{camera, std::vector<Event>(1000)};
    for (std::size_t i = 0; i < batch.events.size(); ++i)
      batch.events[i].t = Timestamp() + std::chrono::microseconds(i);
    return batch;
  };
  EventBatch left = batch_of("left"), right = batch_of("right");
  thinner.thin(left, 0.02);
  EXPECT_EQ(left.events.size(), 1000U) << "20 ms are free";
  thinner.thin(left, 0.06);
  thinner.thin(right, 0.06);
  EXPECT_NEAR(static_cast<double>(left.events.size()), 1000.0 / 3.0, 40.0);
  EXPECT_NEAR(static_cast<double>(right.events.size()), 1000.0 / 3.0, 40.0);
  EXPECT_EQ(thinner.dropped(), 2000U - left.events.size() - right.events.size());
  EventBatch rest = batch_of("left");
  thinner.thin(rest, 1.0, 0.08);
  EXPECT_EQ(rest.events.size(), 1000U) << "the least that is kept has been read";
}

}  // namespace
}  // namespace edged

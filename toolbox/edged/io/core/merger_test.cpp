// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Order, bounds and damage of merged streams.
#include "edged/io/core/merger.hpp"

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <vector>

namespace edged {
namespace {

Timestamp at_ms(double t) { return timestamp_from_seconds(t * 1e-3); }
ImuSample imu_at(double t) { return {at_ms(t), {}, {}}; }
std::vector<Event> events_at(std::initializer_list<double> stamps) {
  std::vector<Event> events;
  for (const double t : stamps) events.push_back({at_ms(t), 1, 1, true});
  return events;
}

/// The measurements that can be popped, with stamps in ms: "I1 E2,3 F4".
std::string popped(Merger& merger) {
  std::string text;
  const auto add = [&](const char* kind, Timestamp t) { text += fmt::format("{}{}", kind, to_ns(t) / 1'000'000); };
  while (const auto m = merger.pop()) {
    if (!text.empty()) text += ' ';
    if (const auto* s = std::get_if<ImuSample>(&*m)) add("I", s->t);
    if (const auto* f = std::get_if<Frame>(&*m)) add("F", f->t);
    if (const auto* b = std::get_if<EventBatch>(&*m))
      for (const Event& e : b->events) add(&e == b->events.data() ? "E" : ",", e.t);
  }
  return text;
}

TEST(Merger, SortsStreamsThatArriveAtDifferentDelaysAndBreaksTiesAsDatasetSays) {
  Repairs repairs;
  Merger merger(repairs);
  merger.expect({{"events"}, {"frames"}, true});
  merger.push(imu_at(0));
  merger.push(imu_at(2));
  merger.push(imu_at(4));
  EXPECT_EQ(popped(merger), "");  // events and frames may still precede
  merger.push(events_at({0, 1, 2, 3, 4}));
  merger.push(Frame{at_ms(2), "frames", {}});
  merger.push(Frame{at_ms(4), "frames", {}});
  EXPECT_EQ(popped(merger), "I0 E0,1 I2 E2 F2");  // up to a millisecond before the stream that lags
  merger.finish();
  EXPECT_EQ(popped(merger), "E3 I4 E4 F4");
  EXPECT_TRUE(repairs.counts().empty());
}

TEST(Merger, CamerasOfAKindAreApartAndTheFirstIsFirstAtEqualStamps) {
  Repairs repairs;
  Merger merger(repairs);
  merger.expect({{"left", "right"}, {"cam0", "cam1"}, false});
  merger.push(events_at({1, 2, 4}), 1);
  merger.push(events_at({0, 1, 3, 5}), 0);
  merger.push(Frame{at_ms(3), "", {}}, 1);
  EXPECT_EQ(popped(merger), "") << "the first frame camera may still precede";
  merger.push(Frame{at_ms(3), "", {}}, 0);
  merger.finish();
  std::string order;
  while (const auto m = merger.pop()) {
    if (const auto* batch = std::get_if<EventBatch>(&*m))
      order += fmt::format("{}{} ", batch->camera, batch->events.size());
    if (const auto* frame = std::get_if<Frame>(&*m)) order += frame->camera + " ";
  }
  EXPECT_EQ(order, "left3 right2 cam0 cam1 right1 left1 ")
      << "batches of two cameras overlap, but none goes beyond a frame";
  EXPECT_TRUE(repairs.counts().empty());
}

TEST(Merger, BatchesSpanAtMostFiveMilliseconds) {
  Repairs repairs;
  Merger merger(repairs);
  merger.expect({{"events"}, {}, false});
  merger.push(events_at({0, 2, 4, 6, 8}));
  merger.finish();
  EXPECT_EQ(popped(merger), "E0,2,4 E6,8");
}

TEST(Merger, WaitsOneSecondForAStreamThatStaysAway) {
  Repairs repairs;
  Merger merger(repairs);
  merger.expect({{"events"}, {"frames"}, true});
  for (int t = 0; t <= 900; t += 100) merger.push(imu_at(t));
  EXPECT_EQ(popped(merger), "");
  merger.push(imu_at(1150));
  EXPECT_EQ(popped(merger), "I0 I100");
}

TEST(Merger, AStreamOnAnotherClockComesWhole) {
  for (const double shift : {-3000.0, 3000.0, 1e9}) {
    Repairs repairs;
    Merger merger(repairs);
    merger.expect({{"events"}, {}, true});
    std::size_t events = 0, samples = 0;
    const auto drain = [&] {
      while (const auto m = merger.pop()) {
        if (const auto* batch = std::get_if<EventBatch>(&*m)) events += batch->events.size();
        samples += std::holds_alternative<ImuSample>(*m);
      }
    };
    for (int t = 0; t < 10'000; t += 2) {
      merger.push(events_at({t + 0.1, t + 1.1}));
      merger.push(imu_at(t + shift));
      drain();
    }
    merger.finish();
    drain();
    EXPECT_EQ(events, 10'000u);
    EXPECT_EQ(samples, 5'000u);
    EXPECT_TRUE(repairs.counts().empty());
  }
}

TEST(Merger, LateItemsAreSortedInWhilePossibleAndCountedAlways) {
  Repairs repairs;
  Merger merger(repairs);
  merger.expect({{"events"}, {}, false});
  merger.push(events_at({10, 20, 15, 30}));
  EXPECT_EQ(popped(merger), "E10 E15 E20");
  merger.push(events_at({12, 40}));
  merger.finish();
  EXPECT_EQ(popped(merger), "E30 E40");
  EXPECT_EQ(repairs.counts().at("events: out of order, sorted in"), 1u);
  EXPECT_EQ(repairs.counts().at("events: out of order, dropped"), 1u);
}

TEST(Merger, RepeatedStampsAreLeftOutOfFramesOnly) {
  Repairs repairs;
  Merger merger(repairs);
  merger.expect({{"events"}, {"frames"}, true});
  merger.push(imu_at(1));
  merger.push(imu_at(1));
  merger.push(events_at({1, 1}));
  merger.push(Frame{at_ms(1), "frames", {}});
  merger.push(Frame{at_ms(1), "frames", {}});
  merger.finish();
  EXPECT_EQ(popped(merger), "I1 I1 E1,1 F1");
  EXPECT_EQ(repairs.counts().at("frames: duplicate stamp"), 1u);
}

TEST(Merger, OneStampFarAheadDoesNotEndTheStream) {
  Repairs repairs;
  Merger merger(repairs);
  merger.expect({{}, {}, true});
  for (const double t : {9e9, 0.0, 5.0, 7e7, 10.0, 15.0}) merger.push(imu_at(t));
  merger.finish();
  EXPECT_EQ(popped(merger), "I0 I5 I10 I15");
  EXPECT_EQ(repairs.counts().at("imu: stamp far ahead, dropped"), 2u);
}

TEST(Merger, AGapThatTheNextStampConfirmsIsKept) {
  Repairs repairs;
  Merger merger(repairs);
  merger.expect({{}, {}, true});
  for (const double t : {0.0, 5.0, 60'000.0, 60'005.0}) merger.push(imu_at(t));
  merger.finish();
  EXPECT_EQ(popped(merger), "I0 I5 I60000 I60005");
  EXPECT_TRUE(repairs.counts().empty());
}

TEST(Merger, HoldsABoundedNumberOfEventsWhoseStampsStandStill) {
  Repairs repairs;
  Merger merger(repairs);
  merger.expect({{"events"}, {}, true});
  const std::vector<Event> many(1'000'000, Event{at_ms(1), 1, 1, true});
  std::size_t out = 0;
  for (int i = 0; i < 6; ++i) {
    merger.push(many);
    while (const auto m = merger.pop()) out += std::get<EventBatch>(*m).events.size();
  }
  EXPECT_GE(out, 2'000'000u);
}

}  // namespace
}  // namespace edged

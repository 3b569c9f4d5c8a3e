// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A camera of 100 pixels: 35 events make a packet, 50 are rendered.
#include "edged/pipeline/input/event_history.hpp"

#include <gtest/gtest.h>

#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

constexpr PacketizerConfig kConfig{.window_per_pixel = 0.5, .max_age_s = 0.1};
Timestamp after_ms(int ms) { return Timestamp(std::chrono::milliseconds(ms)); }

EventHistory history(Duration offset = Duration(0)) {
  return {{"dvs", Modality::Events, CameraModel(10, 10, 10, 10, 5, 5), SE3(), offset}, kConfig};
}

/// One a millisecond.
std::vector<Event> events(int from_ms, int to_ms) {
  std::vector<Event> all;
  for (int ms = from_ms; ms < to_ms; ++ms) all.push_back({after_ms(ms), 1, 1, true});
  return all;
}

TEST(EventHistory, KnowsWhenTheCountOfAPacketIsComplete) {
  EventHistory h = history();
  EXPECT_FALSE(h.newest());
  h.add(events(1, 35), after_ms(0));
  EXPECT_FALSE(h.complete());
  h.add(events(35, 100), after_ms(0));
  EXPECT_EQ(h.complete(), after_ms(35));
  h.take(after_ms(40), after_ms(0));
  EXPECT_EQ(h.complete(), after_ms(75)) << "counted from the cut";
}

TEST(EventHistory, GivesEachEventOnceAsNewAndReachesBackForTheWindow) {
  EventHistory h = history();
  h.add(events(1, 61), after_ms(0));
  const PacketEvents first = h.take(after_ms(40), after_ms(0)), second = h.take(after_ms(60), after_ms(40));
  EXPECT_EQ(first.camera, "dvs");
  EXPECT_EQ(first.new_events, 40U);
  EXPECT_EQ(first.window_events, 40U);
  EXPECT_NEAR(first.event_rate_hz, 1000.0, 1e-9);
  EXPECT_EQ(second.new_events, 20U);
  EXPECT_EQ(second.events.size(), 50U);
  EXPECT_EQ(second.window().front().t, after_ms(11));
  EXPECT_EQ(h.new_events(), 0U);
}

TEST(EventHistory, ForgetsWhatIsTooOldForTheWindow) {
  EventHistory h = history();
  h.add(events(1, 41), after_ms(0));
  h.take(after_ms(40), after_ms(0));
  EXPECT_TRUE(h.take(after_ms(200), after_ms(40)).events.empty());
  EXPECT_FALSE(h.newest()) << "and frees its memory";
}

TEST(EventHistory, LeavesOutWhatIsLateOnTheClockOfTheImu) {
  EventHistory h = history(std::chrono::milliseconds(5));
  EXPECT_EQ(h.add(events(1, 11), after_ms(8)).late, 3U) << "6 to 8 ms are not after the cut";
  EXPECT_EQ(h.newest(), after_ms(15));
  EXPECT_EQ(h.add(events(9, 12), after_ms(8)).late, 1U) << "14 ms is before earlier events";
  EXPECT_EQ(h.give_up(), 9U);
  EXPECT_EQ(h.new_events(), 0U);
}

TEST(EventHistory, LeavesOutWhatABurstHasBeyondTheLargestPacket) {
  EventHistory h = history();
  const std::vector<Event> of_one_stamp(kPipelineTuning.max_burst_events, {after_ms(1), 1, 1, true});
  EXPECT_EQ(h.add(of_one_stamp, after_ms(0)).surplus, 0U) << "a sensor may send each pixel twice";
  EXPECT_EQ(h.add(of_one_stamp, after_ms(0)).surplus, of_one_stamp.size());
  EXPECT_EQ(h.add(events(2, 41), after_ms(0)).surplus, 29U) << "until the burst is over";
  EXPECT_EQ(h.new_events(), of_one_stamp.size() + 10);
}

}  // namespace
}  // namespace edged

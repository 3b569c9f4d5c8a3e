// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/backlog.hpp"

#include <gtest/gtest.h>

namespace edged::node {
namespace {

constexpr Timestamp at(double s) { return timestamp_from_seconds(s); }
EventBatch events_at(double s) { return {"events", {Event{at(s)}, Event{at(s)}}}; }
Frame frame_at(double s) { return {at(s), "frames", cv::Mat()}; }

TEST(Backlog, LeavesOutEventsThenFramesNeverTheImuWhileTheOdometryIsBehind) {
  Backlog backlog(0.25);
  backlog.note_step(at(1.0));
  EXPECT_TRUE(backlog.admit(events_at(1.2)));
  EXPECT_FALSE(backlog.admit(events_at(1.3)));
  EXPECT_TRUE(backlog.admit(frame_at(1.4)));
  EXPECT_FALSE(backlog.admit(frame_at(1.6)));
  EXPECT_TRUE(backlog.admit(ImuSample{at(9.0)}));
  EXPECT_EQ(backlog.counters().events, 2U);
  EXPECT_EQ(backlog.counters().frames, 1U);
  EXPECT_EQ(backlog.age(), duration_from_seconds(8.0));
  backlog.note_step(at(9.0));
  EXPECT_TRUE(backlog.admit(events_at(9.1)));
}

TEST(Backlog, LeavesOutNothingWhileTheOdometryWaitsForASensor) {
  Backlog backlog(0.25);
  EXPECT_TRUE(backlog.admit(events_at(5.0)));
  EXPECT_FALSE(backlog.age());
  backlog.note_step(at(1.0));
  backlog.note_idle();
  EXPECT_TRUE(backlog.admit(events_at(7.0)));
  EXPECT_TRUE(backlog.admit(frame_at(8.0)));
}

TEST(Backlog, TheAgeFollowsClocksThatAreSetBack) {
  Backlog backlog(0.25);
  EXPECT_TRUE(backlog.admit(events_at(100.0)));
  EXPECT_TRUE(backlog.admit(events_at(5.0)));
  backlog.note_step(at(4.9));
  EXPECT_EQ(backlog.age(), duration_from_seconds(0.1));
}

}  // namespace
}  // namespace edged::node

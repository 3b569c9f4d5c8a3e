// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/autopilot/mavlink_output.hpp"

#include <gtest/gtest.h>

#include "edged/autopilot/test_autopilot.hpp"
#include "edged/timing.hpp"

namespace edged {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kOdometrySize = 10 + 233 + 2;

Step good_step(int ms = 0) {
  Step step;
  step.t = step.state.t = Timestamp(milliseconds(ms));
  step.status = TrackingStatus::Good;
  step.landmarks.resize(50);
  return step;
}

/// Sends the predictions of IMU samples at 1 kHz from begin to end.
void fly(MavlinkOutput& output, int begin_ms, int end_ms) {
  NavState state;
  for (int ms = begin_ms; ms < end_ms; ++ms) {
    state.t = Timestamp(milliseconds(ms));
    output.send(state, Eigen::Vector3d::Zero(), MavlinkOutput::unix_now());
  }
}

std::size_t sent(MavlinkOutput& output, int begin_ms, int end_ms) {
  const std::size_t before = output.counters().odometry;
  fly(output, begin_ms, end_ms);
  return output.counters().odometry - before;
}

TEST(MavlinkOutput, SendsAtItsRate) {
  const TestUdp autopilot;
  for (const double rate_hz : {50.0, 300.0, 1000.0}) {
    MavlinkOutput output(autopilot.url(), {.rate_hz = rate_hz});
    output.note(good_step());
    EXPECT_NEAR(static_cast<double>(sent(output, 0, 1000)), rate_hz, 1.0);
    EXPECT_NEAR(static_cast<double>(sent(output, 5000, 6000)), rate_hz, 1.0);  // after a pause
    EXPECT_NEAR(static_cast<double>(sent(output, 0, 1000)), rate_hz, 1.0);     // a clock that jumped back
  }
}

TEST(MavlinkOutput, IsSilentWithoutAPoseAndGoesOnAfterIt) {
  const TestUdp autopilot;
  MavlinkOutput output(autopilot.url(), {});
  EXPECT_EQ(sent(output, 0, 100), 0U);
  output.note(good_step(100));
  EXPECT_EQ(sent(output, 100, 200), 5U);
  Step step = good_step(200);
  step.status = TrackingStatus::Lost;
  output.note(step);
  EXPECT_EQ(sent(output, 200, 300), 0U);
  step.status = TrackingStatus::Degraded;
  step.started = "in motion";
  output.note(step);
  EXPECT_EQ(sent(output, 300, 400), 5U);
  EXPECT_EQ(output.counters().dropped, 0U);
}

TEST(MavlinkOutput, StampsWithTheClockThatAnswersTimesync) {
  const TestUdp autopilot;
  MavlinkOutput output(autopilot.url(), {});
  output.note(good_step());
  const std::int64_t before_ns = MavlinkOutput::unix_now().count();
  output.send(good_step().state, Eigen::Vector3d::Zero(), Duration(before_ns));
  const MavlinkFrame request = MavlinkEncoder({1, 1}).timesync({0, 4711, {0, 0}}, 0);
  autopilot.answer(request);
  std::vector<std::uint8_t> reply = autopilot.receive();
  while (!reply.empty() && reply[7] != kMavlinkTimesync.id) reply = autopilot.receive();  // a heartbeat
  ASSERT_GE(reply.size(), 22U);
  std::int64_t tc1_ns = 0;
  for (std::size_t i = 0; i < 8; ++i) tc1_ns |= std::int64_t{reply[10 + i]} << (8 * i);
  EXPECT_GE(tc1_ns, before_ns);
  EXPECT_LE(tc1_ns, MavlinkOutput::unix_now().count());
  EXPECT_EQ(reply[18] | reply[19] << 8, 4711);
  EXPECT_EQ(output.counters().timesyncs, 1U);
}

TEST(MavlinkOutput, SendsAHeartbeatWithoutAPose) {
  const TestUdp autopilot;
  const MavlinkOutput output(autopilot.url(), {.system_id = 9, .component_id = 42});
  const std::vector<std::uint8_t> heartbeat = autopilot.receive();
  ASSERT_GE(heartbeat.size(), 12U);
  EXPECT_EQ(heartbeat[7], kMavlinkHeartbeat.id);
  EXPECT_EQ(heartbeat[5], 9);
  EXPECT_EQ(heartbeat[6], 42);
}

TEST(MavlinkOutput, ASerialLineThatNobodyReadsDropsAndCounts) {
  const TestSerial autopilot;
  MavlinkOutput output(autopilot.url(), {.rate_hz = 1000.0});
  output.note(good_step());
  fly(output, 0, 1000);
  const MavlinkCounters counters = output.counters();
  EXPECT_GT(counters.odometry, 0U);
  EXPECT_GE(counters.dropped, 1000U - counters.odometry);
}

// No assertion on time: the figure is for docs/autopilot.md.
TEST(MavlinkOutput, TheTimeFromAStateToTheWireIsRecorded) {
  const TestUdp autopilot;
  MavlinkOutput output(autopilot.url(), {.rate_hz = 1000.0});
  output.note(good_step());
  StageTiming timing;
  for (int ms = 0; ms < 2000; ++ms) {
    NavState state;
    state.t = Timestamp(milliseconds(ms));
    const Duration begin = MavlinkOutput::unix_now();
    output.send(state, Eigen::Vector3d::Zero(), begin);
    std::vector<std::uint8_t> frame = autopilot.receive();
    while (!frame.empty() && frame.size() != kOdometrySize) frame = autopilot.receive();
    ASSERT_EQ(frame.size(), kOdometrySize);
    timing.add(to_seconds(MavlinkOutput::unix_now() - begin));
  }
  RecordProperty("p50_us", std::to_string(1e6 * timing.quantile_s(0.5)));
  RecordProperty("p99_us", std::to_string(1e6 * timing.quantile_s(0.99)));
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "topics/stamp_clock.hpp"

#include <gtest/gtest.h>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged::node {
namespace {

using std::chrono::milliseconds;

/// Packets of events every millisecond, an IMU at 200 Hz, frames at 25 Hz; what has been passed on, by topic.
class Stream {
 public:
  /// Until that time of the sensors [ms], with the clock of the stamps set by so much.
  void run(int until_ms, Duration set_by) {
    for (; now_ms_ < until_ms; ++now_ms_) {
      const Timestamp t = timestamp_from_ns(std::int64_t{now_ms_} * 1'000'000);
      if (now_ms_ % 5 == 0)
        pass("imu", ImuSample{t + set_by, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}, nullptr);
      if (now_ms_ % 40 == 0 && now_ms_ != dropped_ms) pass("image", Frame{t + set_by, "frames", {}}, nullptr);
      if (!packets) continue;
      const Duration offset = sensor_.offset(t, t, t + set_by);
      pass("events", EventBatch{"events", {{t + offset, 1, 1, true}}}, &sensor_);
    }
  }
  const std::vector<int>& of(const std::string& topic) { return passed_ms_[topic]; }
  Duration set_by() const { return clock_.set_by(); }
  bool packets = true;
  int dropped_ms = -1;
  int latest_ms = 0;  ///< the longest that a measurement was held

 private:
  void pass(const std::string& topic, Measurement measurement, const SensorClock* sensor) {
    for (const auto& [from, one] : clock_.pass(topic, std::move(measurement), sensor,
                                               {StampClock::Clock::time_point(milliseconds(now_ms_ + 1000))})) {
      passed_ms_[from].push_back(static_cast<int>(std::lround(1e3 * to_seconds(*last_stamp(one)))));
      latest_ms = std::max(latest_ms, now_ms_ - passed_ms_[from].back());
    }
  }
  StampClock clock_;
  SensorClock sensor_;
  int now_ms_ = 0;
  std::map<std::string, std::vector<int>> passed_ms_;
};

class StampClockSet : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Steps, StampClockSet, ::testing::Values(-100.0, -20.0, -0.5, -0.05, 0.05, 0.5, 20.0, 100.0));

TEST_P(StampClockSet, GoesOnWithoutAGapInAnyTopic) {
  const Duration set_by = duration_from_seconds(GetParam());
  for (const int at_ms : {1003, 1035}) {  // soon after a frame, and long after it
    Stream stream;
    stream.run(at_ms, Duration(0));
    stream.run(2000, set_by);
    EXPECT_EQ(stream.set_by(), set_by);
    EXPECT_LE(stream.latest_ms, 25);
    for (const auto& [topic, interval_ms] : std::map<std::string, int>{{"events", 1}, {"imu", 5}, {"image", 40}}) {
      const std::vector<int>& passed = stream.of(topic);
      EXPECT_EQ(passed.size(), 2000U / interval_ms) << topic;
      for (std::size_t i = 0; i < passed.size(); ++i) ASSERT_EQ(passed[i], static_cast<int>(i) * interval_ms) << topic;
    }
  }
}

TEST(StampClock, ADroppedFrameAndAGapInAllSensorsAreNoSteps) {
  Stream stream;
  stream.dropped_ms = 400;
  stream.run(1003, Duration(0));
  EXPECT_EQ(stream.of("image").size(), 25U);
  EXPECT_LE(stream.latest_ms, 25);
  Stream gap;
  gap.run(1000, Duration(0));
  gap.packets = false;  // and none comes for the next 0.3 s
  gap.dropped_ms = 1000;
  gap.run(1300, Duration(0));
  gap.packets = true;
  gap.run(2000, Duration(0));
  EXPECT_EQ(gap.set_by(), Duration(0));
  EXPECT_EQ(gap.of("image").size(), 49U);
}

TEST(StampClock, WithoutThePacketsOfAnEventCameraStampsAreTakenAsTheyAre) {
  Stream stream;
  stream.packets = false;
  stream.run(1000, Duration(0));
  stream.run(2000, std::chrono::seconds(5));
  EXPECT_EQ(stream.of("imu").size(), 400U);
  EXPECT_EQ(stream.of("imu").back(), 1995 + 5000);
  EXPECT_EQ(stream.latest_ms, 0);
}

}  // namespace
}  // namespace edged::node

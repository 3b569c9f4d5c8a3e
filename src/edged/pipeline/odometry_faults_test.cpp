// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The odometry with wrong clocks and stamps, missing and bad measurements, and sensors that lag.
#include <gtest/gtest.h>

#include <cmath>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/odometry.hpp"
#include "edged/pipeline/odometry_test_support.hpp"

namespace edged {
namespace {

TEST(Odometry, ComesBackWhereTheClocksOfItsSensorsAreDecadesApart) {
  Odometry odometry(small_rig(), {}, Mode::Events);
  int steps = 0;
  for (int ms = 0; ms < 500; ms += 5) {
    odometry.add(resting(stamp(ms) + std::chrono::years(50)));
    if (ms >= 200) odometry.add(EventBatch{"dvs", {{stamp(ms), 1, 2, true}}});
    while (odometry.next()) ++steps;  // at standstill, on the clock of the IMU
  }
  EXPECT_LT(steps, 20);
}

/// On the clock of their sensor.
Measurement shifted(Measurement m, Duration by) {
  if (auto* batch = std::get_if<EventBatch>(&m)) {
    for (Event& event : batch->events) event.t += by;
  } else if (auto* frame = std::get_if<Frame>(&m)) {
    frame->t += by;
  } else {
    std::get<ImuSample>(m).t += by;
  }
  return m;
}

TEST(Odometry, StartsAgainWithinASecondOnceTheClockWasSetBack) {
  Odometry odometry(small_rig(), {}, Mode::Fused);
  const auto back = -std::chrono::seconds(10);
  std::vector<Step> steps;
  const auto feed = [&](Duration by) {
    for (const Measurement& m : measurements(3000)) {
      odometry.add(shifted(m, by));
      while (auto step = odometry.next()) steps.push_back(std::move(*step));
    }
  };
  feed(Duration(0));
  ASSERT_EQ(steps.back().status, TrackingStatus::Good);
  const std::size_t before = steps.size();
  feed(std::chrono::seconds(3) + back);
  ASSERT_GT(steps.size(), before + 50);
  const auto first =
      std::ranges::find_if(steps, [&](const Step& s) { return s.t < Timestamp(std::chrono::seconds(-2)); });
  ASSERT_NE(first, steps.end());
  EXPECT_LT(first->t, stamp(4000) + back);
  EXPECT_EQ(first->status, TrackingStatus::Lost);
  EXPECT_EQ(first->lost_because, "a clock was set back");
  EXPECT_EQ(steps.back().status, TrackingStatus::Good);
  EXPECT_TRUE(odometry.newest_state());
  EXPECT_EQ(odometry.counters().intake.clocks_set_back, 1U);
}

TEST(Odometry, GoesOnAfterAStampAnHourAhead) {
  const std::vector<Measurement> all = measurements(1500);
  Odometry odometry(small_rig(), {}, Mode::Fused, {}, {kInOrder});
  Numbers steps;
  for (const Measurement& m : all) {
    odometry.add(m);
    if (std::holds_alternative<ImuSample>(m) && *first_stamp(m) == stamp(700)) {
      for (const Measurement& damaged : {m, Measurement(EventBatch{"dvs", {{stamp(700), 1, 1, true}}})})
        odometry.add(shifted(damaged, std::chrono::hours(1)));
    }
    std::ranges::move(rest_of(odometry), std::back_inserter(steps));
  }
  odometry.finish();
  std::ranges::move(rest_of(odometry), std::back_inserter(steps));
  expect_same_bits(steps, fed_in_order(all, Mode::Fused));
  EXPECT_EQ(odometry.counters().intake.far_ahead, 2U);
}

TEST(Odometry, TellsEveryFiveSecondsThatFramesStayAway) {
  Odometry odometry(small_rig(), {}, Mode::Frames);
  odometry.add(Frame{stamp(5), "cam", blocks()});
  std::vector<Timestamp> steps;
  for (int ms = 0; ms <= 60'000; ms += 5) {
    odometry.add(resting(stamp(ms)));
    while (const auto step = odometry.next()) steps.push_back(step->t);
  }
  ASSERT_EQ(steps.size(), 12U);
  EXPECT_EQ(steps.back(), stamp(55'005));
  EXPECT_EQ(odometry.counters().packets.frames_missing, 11U);
}

TEST(Odometry, LosesNothingWhereACamerasClockIsBehindByMoreThanItsDelay) {
  for (const auto offset : {std::chrono::milliseconds(200), std::chrono::milliseconds(-200)}) {
    Rig rig = small_rig();
    for (RigCamera& camera : rig.cameras) camera.time_offset = offset;
    Odometry odometry(rig, {}, Mode::Fused);
    std::size_t steps = 0;
    for (Measurement m : measurements(1500)) {
      if (auto* frame = std::get_if<Frame>(&m)) frame->t -= offset;
      if (auto* batch = std::get_if<EventBatch>(&m)) {
        for (Event& event : batch->events) event.t -= offset;
      }
      odometry.add(std::move(m));
      while (odometry.next()) ++steps;
    }
    const PacketizerCounters counters = odometry.counters().packets;
    EXPECT_EQ(counters.events_late + counters.frames_late + counters.imu[ImuFault::Late], 0U);
    EXPECT_GT(steps, 20U);
  }
}

TEST(Odometry, CountsWhatIsBadAndNeverThrows) {
  const Rig rig = small_rig();
  Odometry odometry(rig, {}, Mode::Events, {}, {kInOrder});
  const cv::Mat image = blocks();
  for (Measurement m : std::initializer_list<Measurement>{
           Frame{stamp(1), "cam", image}, Frame{stamp(1), "unknown", image},
           EventBatch{"cam", {{stamp(1), 1, 1, true}}},
           EventBatch{"dvs", {{stamp(1), kWidth, 1, true}, {stamp(1), 1, kHeight, true}, {stamp(2), 1, 1, true}}},
           EventBatch{"dvs", {{Timestamp::max(), 1, 1, true}}}, EventBatch{"dvs", {}}, resting(Timestamp::min()),
           ImuSample{stamp(1), {0, 0, std::nan("")}, {0, 0, 9.81}}, resting(stamp(5)), resting(stamp(4))}) {
    odometry.add(std::move(m));
  }
  Odometry with_frames(rig, {}, Mode::Frames, {}, {kInOrder});
  for (Measurement m : std::initializer_list<Measurement>{
           Frame{stamp(1), "cam", cv::Mat()}, Frame{stamp(2), "cam", cv::Mat(kHeight, kWidth, CV_8UC3)},
           Frame{stamp(3), "cam", cv::Mat(kHeight, kWidth - 1, CV_8UC1)}, Frame{stamp(4), "cam", image}}) {
    with_frames.add(std::move(m));
  }
  odometry.finish();
  odometry.add(resting(stamp(6)));
  while (odometry.next()) {
  }
  const OdometryCounters counters = odometry.counters();
  EXPECT_EQ(counters.intake.unknown_camera, 2U);
  EXPECT_EQ(counters.intake.events_outside, 2U);
  EXPECT_EQ(counters.intake.absurd_stamps, 2U);
  EXPECT_EQ(counters.intake.no_room, 1U);
  EXPECT_EQ(counters.packets.imu[ImuFault::NotFinite], 1U);
  EXPECT_EQ(counters.packets.imu[ImuFault::Late], 1U);
  EXPECT_EQ(with_frames.counters().intake.frames_unfit, 3U);
}

TEST(Odometry, LosesNothingOfSensorsThatLagWithinTheirDelaysAndCountsWhatTheyLoseBeyond) {
  std::vector<Measurement> all = measurements(1500);
  const Numbers wanted = fed_in_order(all, Mode::Fused);
  // The events arrive 30 ms, the frames 45 ms after the IMU sample of their time.
  const auto arrival = [](const Measurement& m) {
    const int lag_ms = std::holds_alternative<EventBatch>(m) ? 30 : std::holds_alternative<Frame>(m) ? 45 : 0;
    return *last_stamp(m) + std::chrono::milliseconds(lag_ms);
  };
  std::ranges::stable_sort(all, {}, arrival);
  const auto feed = [&](Odometry& odometry) {
    Numbers steps;
    for (const Measurement& m : all) {
      odometry.add(m);
      std::ranges::move(rest_of(odometry), std::back_inserter(steps));
    }
    odometry.finish();
    std::ranges::move(rest_of(odometry), std::back_inserter(steps));
    return steps;
  };
  Odometry patient(small_rig(), {}, Mode::Fused), hasty(small_rig(), {}, Mode::Fused, {}, {kInOrder});
  expect_same_bits(feed(patient), wanted);
  EXPECT_EQ(patient.counters().packets.events_late + patient.counters().packets.frames_late, 0U);
  feed(hasty);
  EXPECT_GT(hasty.counters().packets.events_late, 100U);
}

}  // namespace
}  // namespace edged

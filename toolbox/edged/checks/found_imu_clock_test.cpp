// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Frames of a camera that turns, with a gyro that counts from its own start, as they arrive
// (tests/program/imu_clock_test.py has recordings).
#include "edged/checks/found_imu_clock.hpp"

#include <gtest/gtest.h>

#include "edged/checks/agreement/test_head.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

/// What came through of all that the head measures until then.
std::vector<Measurement> passed_until(double end_s, TurningHead& head, double ahead_s, LiveImuClock& clock) {
  std::vector<Measurement> passed;
  head.move_until(end_s, ahead_s, [&](Measurement measurement) {
    if (auto through = clock.pass(std::move(measurement))) passed.push_back(std::move(*through));
  });
  return passed;
}

/// Of the first sample [s]; it was measured at a multiple of 5 ms.
double first_imu_s(const std::vector<Measurement>& passed) {
  for (const Measurement& measurement : passed)
    if (const auto* sample = std::get_if<ImuSample>(&measurement)) return to_seconds(sample->t.time_since_epoch());
  return -1.0;
}

TEST(LiveImuClock, IsFoundInTheFirstTenSecondsAndNothingPassesBefore) {
  for (const double ahead_s : {0.15, -1.0, 10.0, 1000.0}) {
    TurningHead head;
    LiveImuClock clock(std::nullopt, 1.0, {&TurningHead::kCamera, 1}, true);
    EXPECT_TRUE(passed_until(9.9, head, ahead_s, clock).empty());
    const auto passed = passed_until(11.0, head, ahead_s, clock);
    ASSERT_TRUE(clock.known());
    EXPECT_EQ(first_stamp(passed.front()), timestamp_from_seconds(10.0)) << "the frame that determines it";
    EXPECT_NEAR(first_imu_s(passed), 10.0, 1e-3);
  }
}

TEST(LiveImuClock, WaitsForRotationAndSearchesAgainWhenTheImuCountsFromItsStartAgain) {
  TurningHead head(20.5);
  LiveImuClock clock(std::nullopt, 1.0, {&TurningHead::kCamera, 1}, true);
  EXPECT_TRUE(passed_until(29.0, head, 1000.0, clock).empty());
  EXPECT_FALSE(clock.known());
  const auto first = passed_until(42.0, head, 1000.0, clock);
  ASSERT_TRUE(clock.known());
  EXPECT_NEAR(std::remainder(first_imu_s(first), 5e-3), 0.0, 1e-3);
  passed_until(43.0, head, -42.0, clock);
  EXPECT_FALSE(clock.known());
  const auto second = passed_until(53.5, head, -42.0, clock);
  ASSERT_TRUE(clock.known());
  EXPECT_NEAR(first_imu_s(second), 52.0, 0.1);
  EXPECT_NEAR(std::remainder(first_imu_s(second), 5e-3), 0.0, 1e-3);
}

TEST(LiveImuClock, ADamagedStampIsNoBeginning) {
  LiveImuClock clock(std::nullopt, 1.0, {&TurningHead::kCamera, 1}, true);
  TurningHead head;
  passed_until(11.0, head, 5.0, clock);
  ASSERT_TRUE(clock.known());
  for (const double stamp_s : {16.0, 1.0, 16.005, 4e8, 16.01, 16.015})
    clock.pass(ImuSample{timestamp_from_seconds(stamp_s), {0, 0, 0}, {0, 0, 9.81}});
  EXPECT_TRUE(clock.known());
}

/// Largest and last error of the stamps of an IMU that drifts by 50 ppm, in 250 s [s]; 12 ms where it is not followed.
std::pair<double, double> errors_with_drift(double turns_until_s) {
  constexpr double kDrift = 5e-5, kAhead_s = 1000.0;
  TurningHead head;
  LiveImuClock clock(std::nullopt, 1.0, {&TurningHead::kCamera, 1}, true);
  double worst_s = 0.0, last_s = 0.0;
  Timestamp before = timestamp_from_seconds(10.0);
  head.move_until(250.0, 0.0, [&](Measurement measurement) {
    const double true_s = to_seconds(*first_stamp(measurement));
    if (auto* sample = std::get_if<ImuSample>(&measurement)) {
      sample->t = timestamp_from_seconds(kAhead_s + (1.0 + kDrift) * true_s);
    } else if (true_s > turns_until_s) {
      std::get<Frame>(measurement).image.setTo(90);
    }
    const auto passed = clock.pass(std::move(measurement));
    if (!passed || !std::holds_alternative<ImuSample>(*passed)) return;
    const Timestamp t = *first_stamp(*passed);
    EXPECT_NEAR(to_seconds(t - before), 5e-3, before == timestamp_from_seconds(10.0) ? 6e-3 : 1e-5) << "a jump";
    before = t;
    last_s = std::abs(to_seconds(t) - true_s);
    worst_s = std::max(worst_s, last_s);
  });
  return {worst_s, last_s};
}

TEST(LiveImuClock, FollowsItsDriftWithoutAJump) {
  const auto [worst_s, last_s] = errors_with_drift(250.0);
  EXPECT_LT(worst_s, 4.5e-3);
  EXPECT_LT(last_s, 1e-3);
}

TEST(LiveImuClock, GoesOnWithTheDriftThatItKnowsWhereNothingTurns) {
  const auto [worst_s, last_s] = errors_with_drift(130.0);
  EXPECT_LT(worst_s, 5e-3);
  EXPECT_LT(last_s, 3e-3);
}

TEST(LiveImuClock, AddsGivenSecondsFromTheFirstSampleOn) {
  LiveImuClock clock(-100.0, 1.5, {}, false);
  for (const double t : {0.0, 2.0}) {
    const auto passed = clock.pass(ImuSample{timestamp_from_seconds(200 + 1.5 * t), {0, 0, 0}, {0, 0, 9.81}});
    ASSERT_TRUE(passed);
    EXPECT_EQ(first_stamp(*passed), timestamp_from_seconds(100.0 + t));
  }
  EXPECT_THROW(LiveImuClock(std::nullopt, 1.0, {}, true), InputError);
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// IMU samples that are merged from two streams, or corrected to another clock.
#include <gtest/gtest.h>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/io/core/imu_interpolator.hpp"
#include "edged/io/core/replaced_streams.hpp"
#include "edged/io/test_support.hpp"

namespace edged {
namespace {

Timestamp in_ms(double t) { return timestamp_from_seconds(1e-3 * t); }

TEST(ImuInterpolator, InterpolatesTheAccelerometerToTheGyro) {
  ImuInterpolator join;
  std::vector<ImuSample> samples;
  const auto take = [&](const std::vector<ImuSample>& more) {
    samples.insert(samples.end(), more.begin(), more.end());
  };
  for (int i = 0; i < 20; ++i) take(join.add_gyro(in_ms(5 * i), {1.0 * i, 0, 0}));  // the gyro arrives late
  for (const double t : {12.0, 28.0, 44.0, 60.0, 300.0, 310.0}) take(join.add_accel(in_ms(t), {0, t, 9.81}));
  take(join.add_gyro(in_ms(305), {7, 0, 0}));
  ASSERT_EQ(samples.size(), 11u) << "from 15 to 60 ms, nothing in the gap, and the last";
  EXPECT_EQ(samples[0].t, in_ms(15));
  EXPECT_EQ(samples[0].gyro_B.x(), 3.0);
  EXPECT_NEAR(samples[0].accel_B.y(), 15.0, 1e-9);
  EXPECT_NEAR(samples[9].accel_B.y(), 60.0, 1e-9);
  EXPECT_NEAR(samples[10].accel_B.y(), 305.0, 1e-9);
}

/// Continuous events, and an IMU sample every 10 ms, with a clock that is twice as fast.
std::unique_ptr<Dataset> twice_as_fast() {
  auto dataset = std::make_unique<ListedDataset>();
  for (int i = 0; i < 10; ++i) {
    dataset->measurements.push_back(ImuSample{.t = in_ms(20 * i), .accel_B = {0, 0, static_cast<double>(i)}});
    if (i < 5)
      dataset->measurements.emplace_back(
          EventBatch{"events", {{in_ms(20 * i + 2), 1, 1, true}, {in_ms(20 * i + 14), 1, 1, true}}});
  }
  return dataset;
}

TEST(ImuClock, BringsTheStampsBackAndKeepsAllInOrder) {
  const auto dataset = with_imu_clock(twice_as_fast(), twice_as_fast(), {Duration(0), 2.0});
  Timestamp last = Timestamp::min();
  std::size_t events = 0, samples = 0;
  while (const auto measurement = dataset->next()) {
    EXPECT_GE(*first_stamp(*measurement), last);
    last = *last_stamp(*measurement);
    if (const auto* batch = std::get_if<EventBatch>(&*measurement)) events += batch->events.size();
    if (const auto* sample = std::get_if<ImuSample>(&*measurement)) {
      EXPECT_EQ(sample->t, in_ms(10 * sample->accel_B.z()));
      ++samples;
    }
  }
  EXPECT_EQ(events, 10u);
  EXPECT_EQ(samples, 10u);
}

}  // namespace
}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/measurements/external_sensor.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(ExternalSensor, EveryAlternativeHasARowThatTurnsItIntoNumbersAndBack) {
  ASSERT_EQ(external_sensors().size(), kExternalSensors);
  for (std::size_t i = 0; i < kExternalSensors; ++i) {
    const ExternalSensor& sensor = external_sensors()[i];
    ExternalNumbers numbers;
    for (std::size_t k = 0; k < sensor.columns.size(); ++k) {
      numbers.values.push_back(1.5 + static_cast<double>(k));
      numbers.sigmas.push_back(0.1 + static_cast<double>(k));
    }
    const ExternalSample sample = sensor.sample(timestamp_from_ns(7), numbers);
    EXPECT_EQ(sample.index(), i);
    EXPECT_EQ(&sensor_of(sample), &sensor);
    EXPECT_EQ(find_external_sensor(sensor.name), &sensor);
    EXPECT_EQ(time_of(sample), timestamp_from_ns(7));
    EXPECT_EQ(sensor.numbers(sample).values, numbers.values);
    EXPECT_EQ(sensor.numbers(sample).sigmas, numbers.sigmas);
  }
  EXPECT_EQ(find_external_sensor("smell"), nullptr);
}

TEST(ExternalSensor, NumbersThatNoSensorMeasuresAreNotPlausible) {
  const Timestamp t = timestamp_from_ns(7);
  EXPECT_TRUE(is_plausible(ExternalSample(HeightSample{t, -12.0, 0.0})));
  EXPECT_FALSE(is_plausible(ExternalSample(HeightSample{t, kNaN, 0.1})));
  EXPECT_FALSE(is_plausible(ExternalSample(HeightSample{t, 1e6, 0.1})));
  EXPECT_FALSE(is_plausible(ExternalSample(HeightSample{t, 1.0, -0.1})));
  EXPECT_FALSE(is_plausible(ExternalSample(HeightSample{t, 1.0, kNaN})));
  EXPECT_TRUE(is_plausible(ExternalSample(VelocitySample{t, {1, 0, 0}, {0.1, kInfinite, kInfinite}})));
  EXPECT_FALSE(is_plausible(ExternalSample(VelocitySample{t, {1, 0, 0}, {kInfinite, kInfinite, kInfinite}})));
}

TEST(ExternalSensor, ASampleIsAMeasurementWithAStampAndNoCamera) {
  const Measurement measurement = ExternalSample(HeightSample{timestamp_from_ns(7), 1.0, 0.0});
  EXPECT_EQ(last_stamp(measurement), timestamp_from_ns(7));
  EXPECT_EQ(first_stamp(measurement), timestamp_from_ns(7));
  EXPECT_EQ(camera_of(measurement), nullptr);
}

}  // namespace
}  // namespace edged

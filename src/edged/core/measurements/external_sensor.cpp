// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/measurements/external_sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

std::vector<double> three(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Eigen::Vector3d vector(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

const std::array<ExternalSensor, kExternalSensors>& table() {
  static const std::array<ExternalSensor, kExternalSensors> sensors{{
      {.name = "height",
       .what = "Height above a level that may drift (barometer, range finder)",
       .columns = {"height"},
       .unit = "m",
       .other_units = {{"cm", 0.01}, {"mm", 0.001}, {"km", 1000.0}, {"ft", 0.3048}, {"feet", 0.3048}},
       .largest = 2e4,
       .sample = [](Timestamp t, const ExternalNumbers& n) -> ExternalSample {
         return HeightSample{t, n.values[0], n.sigmas[0]};
       },
       .numbers = [](const ExternalSample& sample) -> ExternalNumbers {
         const auto& height = std::get<HeightSample>(sample);
         return {{height.height_m}, {height.sigma_m}};
       }},
      {.name = "velocity",
       .what = "Velocity of a sensor on the body in its own axes (wheel odometry, optical flow, DVL)",
       .columns = {"vx", "vy", "vz"},
       .unit = "m/s",
       .other_units = {{"cm/s", 0.01}, {"mm/s", 0.001}, {"ft/s", 0.3048}, {"km/h", 1.0 / 3.6}, {"kn", 1852.0 / 3600.0}},
       .largest = 200.0,
       .sample = [](Timestamp t, const ExternalNumbers& n) -> ExternalSample {
         return VelocitySample{t, vector(n.values), vector(n.sigmas)};
       },
       .numbers = [](const ExternalSample& sample) -> ExternalNumbers {
         const auto& velocity = std::get<VelocitySample>(sample);
         return {three(velocity.v_S), three(velocity.sigma)};
       }},
  }};
  return sensors;
}

}  // namespace

std::span<const ExternalSensor> external_sensors() { return table(); }

const ExternalSensor& sensor_of(const ExternalSample& sample) { return table()[sample.index()]; }

const ExternalSensor* find_external_sensor(std::string_view name) {
  const auto found = std::ranges::find(table(), name, &ExternalSensor::name);
  return found == table().end() ? nullptr : &*found;
}

bool is_plausible(const ExternalSample& sample) {
  const ExternalSensor& sensor = sensor_of(sample);
  const ExternalNumbers numbers = sensor.numbers(sample);
  bool measured = false;
  for (std::size_t i = 0; i < numbers.values.size(); ++i) {
    const double value = numbers.values[i], sigma = numbers.sigmas[i];
    if (!(std::abs(value) <= sensor.largest) || !(sigma >= 0.0)) return false;
    measured = measured || std::isfinite(sigma);
  }
  return measured && is_plausible(time_of(sample));
}

std::string layout_of(const ExternalSensor& sensor) {
  std::string values, sigmas;
  for (const std::string_view column : sensor.columns) {
    values.append(" ").append(column);
    sigmas.append(" sigma_").append(column);
  }
  return "t" + values + (sensor.columns.size() == 1 ? " [sigma]" : " [sigma or" + sigmas + "]");
}

}  // namespace edged

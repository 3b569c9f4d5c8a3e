// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The one table of external sensors: the properties of each that readers, writers, checks, flags and bindings use.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "edged/measurement.hpp"

namespace edged {

/// A sample as plain numbers, one of each kind for every column of its sensor.
struct ExternalNumbers {
  std::vector<double> values;
  std::vector<double> sigmas;  ///< 0: the sensor's option, infinite: not measured
};

/// One alternative of ExternalSample.
struct ExternalSensor {
  std::string_view name;                  ///< as in its files (NAME.txt), its flag (--NAME), its counters
  std::string_view what;                  ///< what it may be, for help texts
  std::vector<std::string_view> columns;  ///< what it measures
  std::string_view unit;                  ///< unit of all columns: "m" or "m/s"
  std::vector<std::pair<std::string_view, double>> other_units;  ///< in the headings of files, each in `unit`
  double largest = 0.0;                                          ///< largest absolute value that is accepted
  ExternalSample (*sample)(Timestamp t, const ExternalNumbers& numbers) = nullptr;
  ExternalNumbers (*numbers)(const ExternalSample& sample) = nullptr;
};

inline constexpr std::size_t kExternalSensors = std::variant_size_v<ExternalSample>;

/// In the order of the alternatives of ExternalSample.
std::span<const ExternalSensor> external_sensors();
const ExternalSensor& sensor_of(const ExternalSample& sample);

/// Null where no sensor has that name.
const ExternalSensor* find_external_sensor(std::string_view name);

/// Its numbers are finite and no larger than such a sensor measures, no sigma is negative, and something is measured.
bool is_plausible(const ExternalSample& sample);

/// What a line of text holds: "t vx vy vz [sigma or sigma_vx sigma_vy sigma_vz]".
std::string layout_of(const ExternalSensor& sensor);

}  // namespace edged

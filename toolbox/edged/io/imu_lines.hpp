// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where the numbers of an IMU sample stand in a line, by the heading of the file or as its data set documents it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "edged/io/stamped_lines.hpp"
#include "edged/io/text_columns.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// Where the numbers of an IMU file stand and what they are.
struct ImuTextForm {
  std::size_t t = 0;
  std::array<std::size_t, 3> gyro{}, accel{};
  TimeUnit unit = TimeUnit::Seconds;
  double gyro_scale = 1.0;   ///< to rad/s
  double accel_scale = 1.0;  ///< to m/s^2
  bool named = false;        ///< the columns, by the first line; else gravity tells which they are
  bool guessed = false;      ///< something of all this is not named, but found from the content
  std::string said;          ///< for the user: columns, units, and what of it is a guess
};

/// `t gx gy gz ax ay az`, as most data sets have it.
ImuTextForm gyro_first(TimeUnit unit);
/// `t ax ay az gx gy gz`, as the Event-Camera Dataset has it.
ImuTextForm accel_first(TimeUnit unit);

/// The columns that the heading names, and the units as far as it names them.
struct NamedImu {
  ImuTextForm form;
  std::optional<TimeUnit> unit;
  std::optional<double> gyro_scale, accel_scale;
};

/// Nothing where the file has no heading. Throws InputError where it does not name each column once.
std::optional<NamedImu> named_imu(const SourcePath& file);

/// exact: lines have no further columns.
StampedLines<ImuSample>::Spec imu_lines(const SourcePath& file, const ImuTextForm& form, bool exact = false);

/// Of a file of a data set: by its heading, with the documented units where that names none; else as documented.
StampedLines<ImuSample>::Spec documented_imu_lines(const SourcePath& file, const ImuTextForm& documented,
                                                   bool exact = false);

}  // namespace edged

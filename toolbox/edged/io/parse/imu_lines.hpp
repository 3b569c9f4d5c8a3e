// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The columns of IMU samples in a text file, by its heading or by the documentation of its data set.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "edged/io/parse/stamped_lines.hpp"
#include "edged/io/parse/text_columns.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// The columns and units of an IMU file.
struct ImuTextForm {
  std::size_t t = 0;
  std::array<std::size_t, 3> gyro{}, accel{};
  TimeUnit unit = TimeUnit::Seconds;
  double gyro_scale = 1.0;   ///< to rad/s
  double accel_scale = 1.0;  ///< to m/s^2
  bool named = false;        ///< the first line names the columns; else gravity identifies them
  bool guessed = false;      ///< a column or unit is not named, but found from the content
  std::string said;          ///< for the user: columns, units, and which of them are guessed
};

/// `t gx gy gz ax ay az`, the order of most data sets.
ImuTextForm gyro_first(TimeUnit unit);
/// `t ax ay az gx gy gz`, the order of the Event-Camera Dataset.
ImuTextForm accel_first(TimeUnit unit);

/// The columns of a heading, and the units that it names.
struct NamedImu {
  ImuTextForm form;
  std::optional<TimeUnit> unit;
  std::optional<double> gyro_scale, accel_scale;
};

/// Nothing for a file without a heading. Throws InputError if the heading does not name each column once.
std::optional<NamedImu> named_imu(const SourcePath& file);

/// exact: lines have no further columns.
StampedLines<ImuSample>::Spec imu_lines(const SourcePath& file, const ImuTextForm& form, bool exact = false);

/// For a file of a data set: the columns of its heading, with the documented units if it names none. Without a heading,
/// the documented columns.
StampedLines<ImuSample>::Spec documented_imu_lines(const SourcePath& file, const ImuTextForm& documented,
                                                   bool exact = false);

}  // namespace edged

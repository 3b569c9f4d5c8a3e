// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// IMU samples in text files: columns and units by the heading, by the documentation of a data set, or by the content.
#pragma once

#include "edged/io/parse/stamped_lines.hpp"
#include "edged/io/parse/text_table.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// The roles of an IMU table are t gx gy gz ax ay az, in rad/s and m/s^2.
/// The lines `t gx gy gz ax ay az`, the order of most data sets.
TextTable gyro_first(TimeUnit unit);
/// The lines `t ax ay az gx gy gz`, the order of the Event-Camera Dataset.
TextTable accel_first(TimeUnit unit);

/// The columns are those of the heading. Without a heading they are `t gx gy gz ax ay az` or `t ax ay az gx gy gz`: the
/// order with gravity in the accelerometer. Units not in the heading are found from the content: gravity, the range of
/// gyros in rad/s, the rates of IMUs. Throws InputError, with the heading to write, if the form is not certain.
TextTable find_imu_table(const SourcePath& file);

/// For a file of a data set: the columns of its heading, with the documented units if it names none. Without a heading,
/// the documented columns. Throws InputError if the heading does not name each column once.
TextTable documented_imu_table(const SourcePath& file, const TextTable& documented);

StampedLines<ImuSample>::Spec imu_lines(const SourcePath& file, const TextTable& table);

}  // namespace edged

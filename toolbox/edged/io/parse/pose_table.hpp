// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Poses in text files: columns and units by the heading or by the conventions of programs.
#pragma once

#include "edged/io/parse/text_table.hpp"
#include "edged/state.hpp"

namespace edged {

/// The roles of a pose table are t, position x y z [m], unit quaternion x y z w.
/// The lines `t tx ty tz qx qy qz qw` of the TUM RGB-D benchmark.
TextTable tum_table(TimeUnit unit);
/// The lines `t px py pz qw qx qy qz ...` of EuRoC.
TextTable euroc_table();

/// The columns of the heading. Nothing for a file without a heading. `unit`: of the stamps, unless the heading names
/// it. Throws InputError if the heading does not name each column once.
std::optional<TextTable> named_pose_table(const SourcePath& file, std::optional<TimeUnit> unit);

/// The columns of the heading, else those of the conventions: with commas and stamps in nanoseconds the scalar is first
/// (EuRoC, VINS), with blanks it is last (TUM, ORB-SLAM3). An unnamed unit of the stamps is the one that gives a
/// present date or the interval of a sensor. Throws InputError if the file holds no poses.
TextTable find_pose_table(const SourcePath& file);

/// A line of such a table, as format_row().
std::string pose_row(const TextTable& table, const StampedPose& pose, char separator);

/// The columns with the other order of the quaternion.
TextTable with_other_scalar(const TextTable& table);

}  // namespace edged

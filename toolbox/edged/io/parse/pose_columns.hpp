// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The columns of poses in a trajectory file, by its heading or by the conventions of programs.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "edged/io/parse/text_columns.hpp"

namespace edged {

/// The columns of a line, which is one pose: stamp, position [m], unit quaternion.
struct PoseColumns {
  std::size_t t = 0;
  std::array<std::size_t, 3> p = {1, 2, 3};
  std::array<std::size_t, 4> q = {4, 5, 6, 7};  ///< x y z w
  TimeUnit unit = TimeUnit::Seconds;
  bool named = false;      ///< by a heading
  bool exact = false;      ///< lines have no further columns
  std::string said = {};   ///< for the user: the order, and how it was found
  std::string doubt = {};  ///< what contradicts the order; "" for nothing
};

/// `t tx ty tz qx qy qz qw` of the TUM RGB-D benchmark.
PoseColumns tum_columns(TimeUnit unit);
/// `t px py pz qw qx qy qz ...` of EuRoC.
PoseColumns euroc_columns();

/// The columns of the heading. Nothing for a file without a heading. `unit`: of the stamps, unless the heading names
/// it. Throws InputError if the heading does not name each column once.
std::optional<PoseColumns> named_pose_columns(const SourcePath& file, std::optional<TimeUnit> unit);

/// The columns of the heading, else those of the conventions: with commas and stamps in nanoseconds the scalar is first
/// (EuRoC, VINS), with blanks it is last (TUM, ORB-SLAM3). An unnamed unit of the stamps is the one that gives a
/// present date or the interval of a sensor. Throws InputError if the file holds no poses.
PoseColumns find_pose_columns(const SourcePath& file);

/// The columns with the other order of the quaternion.
PoseColumns with_other_scalar(const PoseColumns& columns);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where the numbers of a pose stand in a line of a trajectory, by its heading or by the conventions of who writes it.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "edged/io/text_columns.hpp"

namespace edged {

/// One line is one pose: stamp, position [m], unit quaternion.
struct PoseColumns {
  std::size_t t = 0;
  std::array<std::size_t, 3> p = {1, 2, 3};
  std::array<std::size_t, 4> q = {4, 5, 6, 7};  ///< x y z w
  TimeUnit unit = TimeUnit::Seconds;
  bool named = false;      ///< by a heading
  bool exact = false;      ///< lines have no further columns
  std::string said = {};   ///< for the user: the order, and where it comes from
  std::string doubt = {};  ///< what speaks against it; "" where nothing does
};

/// `t tx ty tz qx qy qz qw` of the TUM RGB-D benchmark.
PoseColumns tum_columns(TimeUnit unit);
/// `t px py pz qw qx qy qz ...` of EuRoC.
PoseColumns euroc_columns();

/// The columns that the heading names; nothing where the file has none. `unit`: where the heading names none. Throws
/// InputError where it does not name each column once.
std::optional<PoseColumns> named_pose_columns(const SourcePath& file, std::optional<TimeUnit> unit);

/// By the heading, else by the conventions: behind commas and stamps in nanoseconds the scalar comes first (EuRoC,
/// VINS), behind blanks last (TUM, ORB-SLAM3). The unit of the stamps, where no name tells it, is the one in which they
/// are of today or a sensor's distance apart. Throws InputError where the file holds no poses.
PoseColumns find_pose_columns(const SourcePath& file);

/// The other of the two orders of the quaternion.
PoseColumns with_other_scalar(const PoseColumns& columns);

}  // namespace edged

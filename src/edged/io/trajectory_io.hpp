// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Trajectories as text: TUM, EuRoC csv and KITTI.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "edged/core/types.hpp"

namespace edged {

/// TUM: `t tx ty tz qx qy qz qw` [s, m], # comments. Stamps are exact to the nanosecond, exponents included. Repeated stamps
/// keep the first pose (logged). Throws InputError naming file and line.
Trajectory read_tum(const std::filesystem::path& file);

/// EuRoC csv: `t_ns, px, py, pz, qw, qx, qy, qz, ...`; further columns are ignored.
Trajectory read_euroc_csv(const std::filesystem::path& file);

/// KITTI: 12 numbers of [R | t], row by row; the line index counts as seconds.
Trajectory read_kitti(const std::filesystem::path& file);

/// Any of the three, told apart by the number of columns and the size of the stamps.
Trajectory read_trajectory(const std::filesystem::path& file);

enum class TrajectoryFormat { Tum, EurocCsv };

/// Writes pose after pose, so that an interrupted run leaves a complete file. Numbers read back to the same bits.
class TrajectoryWriter {
 public:
  /// comments: each becomes a line that starts with "# ". Throws InputError when the file cannot be made.
  TrajectoryWriter(const std::filesystem::path& file, TrajectoryFormat format, const std::vector<std::string>& comments);
  void add(const StampedPose& pose);

 private:
  std::ofstream out_;
  TrajectoryFormat format_;
};

void write_tum(const std::filesystem::path& file, const Trajectory& trajectory,
               const std::vector<std::string>& comments = {});
void write_euroc_csv(const std::filesystem::path& file, const Trajectory& trajectory,
                     const std::vector<std::string>& comments = {});

}  // namespace edged

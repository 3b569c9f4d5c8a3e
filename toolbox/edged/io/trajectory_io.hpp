// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Trajectories as text: TUM, EuRoC csv and KITTI.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "edged/io/pose_columns.hpp"
#include "edged/io/source_path.hpp"
#include "edged/state.hpp"

namespace edged {

/// Told of each line that is left out, by its number and what is wrong with it.
using DamageHandler = std::function<void(std::size_t line, const std::string& detail)>;

/// TUM: `t tx ty tz qx qy qz qw` [s, m], # comments, unless a heading names other columns. Stamps are exact to the
/// nanosecond, exponents included, and rise strictly in what is returned. A bad line (unreadable, not finite, no unit
/// quaternion, stamp not after the one above) goes to on_damage; without it, InputError naming file and line, but a
/// repeated stamp only keeps the first pose (logged).
Trajectory read_tum(const SourcePath& file, const DamageHandler& on_damage = {});

/// The same with stamps in microseconds (TUM-VIE).
Trajectory read_tum_microseconds(const SourcePath& file, const DamageHandler& on_damage = {});

/// EuRoC csv: `t_ns, px, py, pz, qw, qx, qy, qz, ...`; further columns are ignored. Damage as read_tum.
Trajectory read_euroc_csv(const SourcePath& file, const DamageHandler& on_damage = {});

/// KITTI: 12 numbers of [R | t], row by row; the index of the pose counts as seconds. Damage as read_tum.
Trajectory read_kitti(const std::filesystem::path& file, const DamageHandler& on_damage = {});

/// How a file of poses reads.
struct TrajectoryForm {
  bool untimed = false;  ///< KITTI
  PoseColumns columns;   ///< of all others; `said` and `doubt` of KITTI, too
};

/// By heading, columns, separators and stamps. Throws InputError where the file holds no poses.
TrajectoryForm find_trajectory_form(const SourcePath& file);

/// Of any program: TUM, EuRoC, KITTI, ORB-SLAM3, OKVIS2, OpenVINS, VINS-Mono and VINS-Fusion, Kalibr, maplab.
Trajectory read_trajectory(const SourcePath& file, const TrajectoryForm& form);
/// The same, with a warning where the form is in doubt.
Trajectory read_trajectory(const SourcePath& file);

enum class TrajectoryFormat { Tum, EurocCsv, Kitti };

/// Writes pose after pose, so that an interrupted run leaves a complete file. Numbers read back to the same bits, but
/// for KITTI's, which are those of a matrix.
class TrajectoryWriter {
 public:
  /// comments: each becomes a line that starts with "# "; KITTI has none, as its readers take every line for a pose.
  /// Throws InputError when the file cannot be made.
  TrajectoryWriter(const std::filesystem::path& file, TrajectoryFormat format,
                   const std::vector<std::string>& comments);
  void add(const StampedPose& pose);
  /// Throws InputError when the disk is full.
  void flush();

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  TrajectoryFormat format_;
};

void write_tum(const std::filesystem::path& file, const Trajectory& trajectory,
               const std::vector<std::string>& comments = {});
void write_euroc_csv(const std::filesystem::path& file, const Trajectory& trajectory,
                     const std::vector<std::string>& comments = {});

}  // namespace edged

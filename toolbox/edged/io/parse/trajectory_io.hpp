// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Trajectories as text, TUM, EuRoC csv, KITTI and others: columns and units by the heading or by the conventions of
// programs.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "edged/dataset.hpp"
#include "edged/io/archive/source_path.hpp"
#include "edged/io/parse/repairs.hpp"
#include "edged/io/parse/text_table.hpp"
#include "edged/state.hpp"

namespace edged {

/// The roles of a pose table are t, position x y z [m], unit quaternion x y z w.
/// The lines `t tx ty tz qx qy qz qw` of the TUM RGB-D benchmark.
TextTable tum_table(TimeUnit unit);
/// The lines `t px py pz qw qx qy qz ...` of EuRoC.
TextTable euroc_table();

/// A line of such a table, as format_row().
std::string pose_row(const TextTable& table, const StampedPose& pose, char separator);

/// The columns with the other order of the quaternion.
TextTable with_other_scalar(const TextTable& table);

/// Called with the number and the error of each line that is left out.
using DamageHandler = std::function<void(std::size_t line, const std::string& detail)>;

/// The poses of a file of a data set, in the columns of its heading, else in the documented ones. Stamps are exact to
/// the nanosecond, also with exponents. The returned stamps are strictly increasing. on_damage is called for a bad line
/// (unreadable, not finite, no unit quaternion, stamp not after the previous one). Without on_damage, throws InputError
/// with file and line; only of a repeated stamp, the first pose is kept and a warning logged.
Trajectory read_poses(const SourcePath& file, const TextTable& documented, const DamageHandler& on_damage = {});

/// The poses of a file in the format of TUM, as read_poses().
Trajectory read_tum(const SourcePath& file);

/// The poses of that frame, by read_poses(). Bad lines are counted. Nothing for a file without poses.
std::optional<GroundTruth> read_ground_truth(const SourcePath& file, const TextTable& documented,
                                             const std::string& frame, Repairs& repairs);

/// The form of a file of poses.
struct TrajectoryForm {
  bool untimed = false;  ///< KITTI: 12 numbers of [R | t], row by row; the index of a pose is its time in seconds
  TextTable columns;     ///< for other formats; `said` and `doubt` also of KITTI
};

/// Detects the form by heading, columns, separators and stamps. Throws InputError if the file holds no poses.
TrajectoryForm find_trajectory_form(const SourcePath& file);

/// Reads the trajectory of any program: TUM, EuRoC, KITTI, ORB-SLAM3, OKVIS2, OpenVINS, VINS-Mono and VINS-Fusion,
/// Kalibr, maplab.
Trajectory read_trajectory(const SourcePath& file, const TrajectoryForm& form);
/// Detects the form, with a warning if it is not certain.
Trajectory read_trajectory(const SourcePath& file);

enum class TrajectoryFormat { Tum, EurocCsv, Kitti };

/// Writes pose after pose, so that an interrupted run leaves a complete file. Numbers read back to the same bits,
/// except for KITTI, which holds matrices.
class TrajectoryWriter {
 public:
  /// comments: each becomes a line that starts with "# ". Not written for KITTI, whose readers take each line as a
  /// pose. Throws InputError if the file cannot be created.
  TrajectoryWriter(const std::filesystem::path& file, TrajectoryFormat format,
                   const std::vector<std::string>& comments);
  void add(const StampedPose& pose);
  /// Throws InputError if the disk is full.
  void flush();

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  TrajectoryFormat format_;
};

void write_tum(const std::filesystem::path& file, const Trajectory& trajectory,
               const std::vector<std::string>& comments = {});

}  // namespace edged

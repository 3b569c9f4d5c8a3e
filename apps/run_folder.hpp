// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The folder a run leaves behind, its files written as the run goes.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "edged/camera/output_frame.hpp"
#include "edged/io/trajectory_io.hpp"
#include "edged/odometry.hpp"
#include "edged/timing.hpp"

namespace edged {

/// What becomes of an earlier run in the folder that is asked for.
enum class EarlierRun { Keep, Replace };

/// Makes the folder and returns it. Where it holds an earlier run, that run's files are replaced, or it is kept and the
/// folder gets a number: FOLDER-2, FOLDER-3, the first that is free. Runs that begin at once never get the same. Throws
/// InputError when the path is something else: a file, or a folder that holds things but no run.
std::filesystem::path make_run_folder(const std::filesystem::path& wanted, EarlierRun earlier = EarlierRun::Keep);

/// Of a run that does not begin: takes its mark away, and the folder where nothing else is in it.
void give_back_run_folder(const std::filesystem::path& folder);

/// FOLDER with the suffix behind its name, also where it is written as FOLDER/ or `.`
std::filesystem::path beside(const std::filesystem::path& folder, const std::string& suffix);

/// Replaces the file, at once: whoever reads it or ends the program meanwhile finds the old one or the new one. Throws
/// InputError when it cannot be written.
void write_file(const std::filesystem::path& file, const std::string& content);

/// Count, mean, p50, p95, p99, total and, where it was taken, processor time of every stage, as json text.
std::string timing_json(const StageTimings& pipeline, const StageTimings& program);

/// Since the oldest keyframe of which the map found a point in this packet's image; nothing where it found none.
std::optional<double> map_reach_s(const Step& step);

/// trajectory.tum, trajectory_euroc.csv, trajectory.kitti and states.csv: complete lines up to the last packet,
/// whenever the program ends.
class RunWriter {
 public:
  /// comments head the trajectory files.
  RunWriter(const std::filesystem::path& folder, const OutputFrame& frame, const std::vector<std::string>& comments);

  /// Every packet becomes a line of states.csv, with pose and motion unless Initializing; Good and Degraded ones become
  /// poses.
  void add(const Step& step);

  std::size_t poses() const { return poses_; }

 private:
  /// All that was given is in the files. Throws InputError when the disk is full.
  void flush();

  OutputFrame frame_;
  TrajectoryWriter tum_;
  TrajectoryWriter euroc_;
  TrajectoryWriter kitti_;  ///< line i is pose i of the others
  std::filesystem::path states_file_;
  std::ofstream states_;
  std::size_t poses_ = 0;
};

}  // namespace edged

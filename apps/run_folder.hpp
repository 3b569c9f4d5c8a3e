// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The folder a run leaves behind, its files written as the run goes.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "edged/camera/output_frame.hpp"
#include "edged/core/timing.hpp"
#include "edged/eval/consistency.hpp"
#include "edged/io/trajectory_io.hpp"
#include "edged/odometry.hpp"

namespace edged {

/// Makes the folder, or empties an earlier run's folder of that run's files. Throws InputError when the path is
/// something else: a file, or a folder that holds things but no run.
void make_run_folder(const std::filesystem::path& folder);

/// Replaces the file, at once: whoever reads it or ends the program meanwhile finds the old one or the new one. Throws
/// InputError when it cannot be written.
void write_file(const std::filesystem::path& file, const std::string& content);

/// Count, mean, p50, p95, p99 and total of every stage, as json text.
std::string timing_json(const StageTimings& pipeline, const StageTimings& program);

/// trajectory.tum, trajectory_euroc.csv and states.csv: complete lines up to the last packet, whenever the program
/// ends.
class RunWriter {
 public:
  /// comments head the trajectory files.
  RunWriter(const std::filesystem::path& folder, const OutputFrame& frame, const std::vector<std::string>& comments);

  /// Every packet becomes a line of states.csv, with pose and motion unless Initializing; Good and Degraded ones become
  /// poses.
  void add(const Step& step);

  std::size_t poses() const { return poses_; }

 private:
  OutputFrame frame_;
  TrajectoryWriter tum_;
  TrajectoryWriter euroc_;
  std::ofstream states_;
  std::size_t poses_ = 0;
};

/// What was written into the folder: a run need not hold it.
struct WrittenStates {
  Trajectory body;                  ///< T_W_B on the IMU clock
  std::vector<ClaimedPose> claims;  ///< those of them whose covariance was worked out anew
};
WrittenStates read_states(const std::filesystem::path& folder);

}  // namespace edged

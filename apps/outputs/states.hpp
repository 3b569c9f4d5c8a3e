// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The files that grow with every packet: trajectories, states.csv and pace.csv.
#pragma once

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "edged/camera/output_frame.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "edged/step.hpp"
#include "run/run_statistics.hpp"

namespace edged {

/// trajectory.tum, trajectory_euroc.csv and trajectory.kitti.
class TrajectoryFiles {
 public:
  static constexpr std::array kNames{"trajectory.tum", "trajectory_euroc.csv", "trajectory.kitti"};
  /// comments head the first two.
  TrajectoryFiles(const std::filesystem::path& folder, const std::vector<std::string>& comments);
  void add(const StampedPose& pose);
  void flush();

 private:
  TrajectoryWriter tum_;
  TrajectoryWriter euroc_;
  TrajectoryWriter kitti_;  ///< line i is pose i of the others
};

/// These and states.csv: complete lines up to the last packet,
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
  /// Flushes all files. Throws InputError when the disk is full.
  void flush();

  OutputFrame frame_;
  TrajectoryFiles trajectory_;
  std::filesystem::path states_file_;
  std::ofstream states_;
  std::size_t poses_ = 0;
};

/// pace.csv: complete lines, as those of states.csv, which is the same in every run.
class PaceWriter {
 public:
  explicit PaceWriter(const std::filesystem::path& folder);
  void add(Timestamp t, const PacketPace& pace);

 private:
  std::ofstream out_;
};

}  // namespace edged

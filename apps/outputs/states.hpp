// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The files that grow with every packet: trajectories and states.csv.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "common/files.hpp"
#include "edged/camera/output_frame.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "edged/step.hpp"
#include "run/run_statistics.hpp"

namespace edged {

/// trajectory.tum, trajectory_euroc.csv and trajectory.kitti.
class TrajectoryFiles {
 public:
  static constexpr std::array kNames{"trajectory.tum", "trajectory_euroc.csv", "trajectory.kitti"};
  /// comments head the first two files.
  TrajectoryFiles(const std::filesystem::path& folder, const std::vector<std::string>& comments);
  void add(const StampedPose& pose);
  void flush();

 private:
  std::vector<TrajectoryWriter> files_;  ///< line i of trajectory.kitti is pose i of the others
};

/// The trajectory files and states.csv: complete lines up to the last packet,
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
  OutputFrame frame_;
  TrajectoryFiles trajectory_;
  TableFile states_;
  std::size_t poses_ = 0;
};

}  // namespace edged

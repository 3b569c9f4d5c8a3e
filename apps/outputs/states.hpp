// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The files that grow with every packet: trajectories and states.csv.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/files.hpp"
#include "edged/io/parse/trajectory_io.hpp"
#include "edged/step.hpp"
#include "run/run_statistics.hpp"

namespace edged {

/// The trajectory files and states.csv: complete lines up to the last packet,
/// whenever the program ends.
class RunWriter {
 public:
  /// frame: whose poses (Step::pose_of); comments head the trajectory files.
  RunWriter(const std::filesystem::path& folder, std::string frame, const std::vector<std::string>& comments);

  /// Every packet becomes a line of states.csv, with pose and motion unless Initializing; Good and Degraded ones become
  /// poses.
  void add(const Step& step);

  std::size_t poses() const { return poses_; }

 private:
  std::string frame_;
  std::vector<TrajectoryWriter> trajectories_;  ///< line i of trajectory.kitti is pose i of the others
  TableFile states_;
  std::size_t poses_ = 0;
};

}  // namespace edged

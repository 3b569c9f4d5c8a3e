// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A run as one MCAP file for Foxglove, Lichtblick and others that read their schemas (results.mcap).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/even_sample.hpp"
#include "edged/final_trajectory.hpp"
#include "edged/io/ros/bag/message_records.hpp"
#include "outputs/foxglove.hpp"
#include "outputs/snapshots.hpp"
#include "run/run_summary.hpp"

namespace edged {

/// Metadata of a results file: version, options ...
using FileMetadata = std::map<std::string, std::string>;

/// Observes the steps; docs/report.md lists the topics. Writes numbers with every step, images, causal path and map at
/// rates of their own. Keeps a chunk, the index, and some hundred poses in memory.
class ResultsMcap {
 public:
  /// rig: the cameras of the mode. Throws InputError where the file cannot be written, as all members do.
  ResultsMcap(const std::filesystem::path& file, Rig rig, const FileMetadata& metadata);

  void add(const Step& step, const Snapshots& snapshots);
  /// Writes the final trajectory and the map. truth: of the body, in the world of the estimate; may be empty.
  void finish(const FinalTrajectory& final_trajectory, const Snapshots& snapshots, const Trajectory& truth,
              const RunSummary& summary);

 private:
  /// A timer for topics with a rate of their own.
  class Pace {
   public:
    explicit Pace(Duration period) : period_(period) {}
    bool due(Timestamp t);

   private:
    Duration period_;
    std::optional<Timestamp> last_;
  };

  void put(const std::string& topic, const char* type, Timestamp t, const foxglove::Json& message);
  void describe_cameras(Timestamp t);
  void put_pose(const Step& step);
  void put_pictures(const Step& step);
  void put_keyframes(Timestamp t);
  void put_status(const Step& step);

  McapWriter file_;
  Rig rig_;  ///< of its images: those of events without distortion
  std::map<std::string, std::size_t> topics_;
  std::optional<Timestamp> first_;
  Timestamp last_{};
  std::optional<TrackingStatus> status_;
  EvenSample<StampedPose> path_{300}, keyframes_{100};
  std::map<std::string, Pace> picture_paces_;  ///< by camera
  Pace path_pace_, map_pace_;
};

}  // namespace edged

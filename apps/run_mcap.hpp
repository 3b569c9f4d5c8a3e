// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A run as one MCAP file for Foxglove, Lichtblick and others that read their schemas (results.mcap).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "edged/io/mcap_writer.hpp"
#include "edged/odometry.hpp"
#include "evenly.hpp"
#include "foxglove.hpp"
#include "run_album.hpp"
#include "run_summary.hpp"

namespace edged {

/// What a program needs to say about a file of results: version, options.
using RunFacts = std::map<std::string, std::string>;

/// Looks at the steps as they come; docs/report.md lists the topics. Numbers come with every step, pictures, path and
/// map at rates of their own, as they were known at the time. It holds a chunk, the index, and some hundred poses.
class RunMcap {
 public:
  /// rig: the cameras of the mode. Throws InputError where the file cannot be written, as all members do.
  RunMcap(const std::filesystem::path& file, Rig rig, const RunFacts& facts);

  void add(const Step& step, const RunAlbum& album);
  /// The path and the map as known in the end. truth: of the body, in the world of the estimate; none where there is
  /// none.
  void finish(const FinalTrajectory& known, const RunAlbum& album, const Trajectory& truth, const RunSummary& summary);

 private:
  /// Says when it is time again.
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
  void put_picture(const Step& step, Modality modality, Pace& pace);
  void put_keyframes(Timestamp t);
  void put_status(const Step& step);

  McapWriter file_;
  Rig rig_;  ///< as its pictures are: those of events without distortion
  std::map<std::string, std::size_t> topics_;
  std::optional<Timestamp> first_;
  Timestamp last_{};
  std::optional<TrackingStatus> status_;
  Evenly<StampedPose> path_{300}, keyframes_{100};
  Pace event_pace_, frame_pace_, path_pace_, map_pace_;
};

}  // namespace edged

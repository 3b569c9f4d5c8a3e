// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run_map.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <utility>
#include <vector>

#include "edged/core/check.hpp"
#include "map_file.hpp"
#include "run_folder.hpp"

namespace edged {

void add_map_options(CLI::App& app, MapOptions& options) {
  app.add_option("--map", options.load,
                 "Go on in the map that --save-map of an earlier run wrote: poses are in its frame once a place of it "
                 "has been recognised");
  app.add_option("--save-map", options.save, "Keep what has been seen in this file, which may be that of --map");
}

RunMap::RunMap(MapOptions options, bool enabled, Odometry& odometry) : options_(std::move(options)) {
  if (options_.load.empty() && options_.save.empty()) return;
  if (!enabled) throw InputError("--map and --save-map want the map: leave out map.enabled=false");
  if (!options_.save.empty()) check_folder_of(options_.save);
  if (options_.load.empty()) return;
  const std::string bytes = read_map_bytes(options_.load);
  try {
    odometry.load_map(bytes);
  } catch (const InputError& e) {
    throw InputError::format("{}: {}", options_.load.string(), e.what());
  }
}

void RunMap::observe(const Step& step, const Odometry& odometry) {
  if (!is_tracking(step.status)) return;
  if (!first_pose_) first_pose_ = step.t;
  if (!options_.load.empty() && !found_ && !odometry.awaiting_relocalization()) found_ = step.t;
}

std::optional<MapSummary> RunMap::finish(const Odometry& odometry) {
  if (options_.load.empty() && options_.save.empty()) return std::nullopt;
  MapSummary summary{options_.load.string(), {}, {}};
  if (found_) summary.found_s = to_seconds(*found_ - *first_pose_);
  if (!options_.load.empty() && !found_)
    spdlog::warn(
        fmt::format("--map {}: not found again; the poses are in a frame of their own", options_.load.string()));
  if (options_.save.empty()) return summary;
  const std::optional<std::string> map = odometry.save_map();
  if (map) {
    write_file(options_.save, *map);
    summary.saved = options_.save.string();
  } else {
    spdlog::warn(fmt::format("--save-map {}: not written, as this run has not found its place in that of --map",
                             options_.save.string()));
  }
  return summary;
}

Trajectory RunMap::in_one_frame(Trajectory poses) const {
  if (found_) std::erase_if(poses, [&](const StampedPose& pose) { return pose.t < *found_; });
  return poses;
}

}  // namespace edged

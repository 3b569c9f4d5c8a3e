// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Maps that outlive a run: --map and --save-map of `edged run`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "cli_fwd.hpp"
#include "edged/odometry.hpp"
#include "edged/state.hpp"
#include "edged/time.hpp"

namespace edged {

struct MapOptions {
  std::filesystem::path load, save;  ///< "": none
};
void add_map_options(CLI::App& app, MapOptions& options);

/// What became of them.
struct MapSummary {
  std::string loaded;             ///< file; empty: none was given
  std::optional<double> found_s;  ///< from the first pose until the body was found in it
  std::string saved;              ///< file; empty: none was asked for, or there was nothing to save
};

class RunMap {
 public:
  /// Gives the odometry the map to go on in. Throws InputError, with the file's name, where that cannot be used or the
  /// other could not be written in the end.
  RunMap(MapOptions options, bool enabled, Odometry& odometry);

  void observe(const Step& step, const Odometry& odometry);
  /// Writes the map that is to be kept. Nothing where no map was asked for.
  std::optional<MapSummary> finish(const Odometry& odometry);
  /// The poses of one frame: where a map was given and found, those in it.
  Trajectory in_one_frame(Trajectory poses) const;

 private:
  MapOptions options_;
  std::optional<Timestamp> first_pose_, found_;
};

}  // namespace edged

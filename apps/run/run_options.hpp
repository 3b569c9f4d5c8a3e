// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options of `edged run`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config_source.hpp"
#include "common/source.hpp"

namespace edged {

struct MapOptions {
  std::filesystem::path load, save;  ///< "": none
  bool localize_only = false;        ///< option map.localize_only
};

/// A folder for programs that reconstruct from images.
struct ExportOptions {
  std::filesystem::path folder;  ///< "": none
  double rate_hz = 0.0;          ///< of its images; 0: those of the keyframes
};

/// A folder for planners.
struct OccupancyOptions {
  std::filesystem::path folder;   ///< "": none
  double voxel_m = 0.05;          ///< edge of its voxels
  std::vector<double> heights_m;  ///< of its slice: from, to; empty: those of the path
};

struct RunOptions {
  SourceOptions source;
  ConfigSource config;
  MapOptions map;
  ExportOptions exports;
  OccupancyOptions occupancy;
  std::string mode = "auto";
  std::string frame = "auto";
  std::filesystem::path out;
  std::vector<std::string> more;  ///< recordings, and options as key=value
  int jobs = 1;
  bool force = false;
  bool quiet = false;
  bool json = false;
  bool live = false;
  bool mcap = false;
  bool dense = false;
  std::string archive;  ///< which file; "true" for the one beside the folder; "" for none
  std::string serve;    ///< address; "true" for the default; "" without a live page
  std::string mavlink;  ///< URL of the autopilot; "" without one
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_map.hpp"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <fstream>
#include <iterator>
#include <utility>
#include <vector>

#include "common/files.hpp"
#include "edged/core/check.hpp"
#include "run/run_observer.hpp"

namespace edged {
namespace {

/// read: a function of the file's bytes. Adds the file's name to its errors.
template <typename Read>
auto read_map_file(const std::filesystem::path& file, Read read) {
  std::error_code ignored;
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file, ignored))
    throw InputError::format("{}: not a readable map; `edged run RECORDING --save-map FILE` makes one", file.string());
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  try {
    return read(bytes);
  } catch (const InputError& e) {
    throw InputError::format("{}: {}", file.string(), e.what());
  }
}

class RunMap : public RunObserver {
 public:
  /// Loads the map of --map. Throws InputError, with the file's name, if that cannot be used or that of --save-map
  /// cannot be written.
  explicit RunMap(RunContext& run) : run_(run), options_(run.options.map) {
    if (!run.config.odometry.map.enabled)
      throw InputError("--map and --save-map need the map: leave out map.enabled=false");
    if (!options_.save.empty()) check_folder_of(options_.save);
    if (!options_.load.empty())
      read_map_file(options_.load, [&run](const std::string& bytes) { run.odometry.load_map(bytes); });
  }

  void on_step(const Step& step) override {
    if (!is_tracking(step.status)) return;
    if (!first_pose_) first_pose_ = step.t;
    if (!options_.load.empty() && !found_ && !run_.odometry.awaiting_relocalization()) found_ = step.t;
  }

  /// Writes the map of --save-map.
  void on_summary(RunEnd& end) override {
    MapSummary& summary = end.summary.map.emplace(MapSummary{options_.load.string(), {}, {}});
    end.in_map_since = found_;
    if (found_) summary.found_s = to_seconds(*found_ - *first_pose_);
    if (!options_.load.empty() && !found_)
      spdlog::warn(
          fmt::format("--map {}: not relocalized; the poses are in a frame of their own", options_.load.string()));
    if (options_.save.empty()) return;
    if (const std::optional<std::string> map = run_.odometry.save_map()) {
      write_file(options_.save, *map);
      summary.saved = options_.save.string();
    } else {
      spdlog::warn(fmt::format("--save-map {}: not written, as this run has not been relocalized in that of --map",
                               options_.save.string()));
    }
  }

 private:
  const RunContext& run_;
  MapOptions options_;
  std::optional<Timestamp> first_pose_, found_;
};

}  // namespace

void add_map_options(CLI::App& app, MapOptions& options) {
  app.add_option("--map", options.load,
                 "Relocalize in a map of --save-map: poses are in its frame once "
                 "relocalized");
  app.add_option("--save-map", options.save, "Save the map to this file, which may be that of --map");
}

SavedMap read_map(const std::filesystem::path& file) { return read_map_file(file, saved_map_from_bytes); }

std::unique_ptr<RunObserver> observe_map(RunContext& run) {
  const MapOptions& map = run.options.map;
  return map.load.empty() && map.save.empty() ? nullptr : std::make_unique<RunMap>(run);
}

}  // namespace edged

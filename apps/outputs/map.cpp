// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "outputs/map.hpp"

#include <spdlog/fmt/fmt.h>
#include <CLI/CLI.hpp>

#include "common/files.hpp"
#include "edged/core/check.hpp"
#include "run/run_context.hpp"

namespace edged {
namespace {

using Json = nlohmann::ordered_json;

struct MapOptions {
  std::filesystem::path load, save;  ///< "": none
};

/// read: a function of the file's bytes. Adds the file's name to its errors.
template <typename Read>
auto read_map_file(const std::filesystem::path& file, Read read) {
  const std::optional<std::string> bytes = read_file(file);
  if (!bytes)
    throw InputError::format("{}: not a readable map; `edged run RECORDING --save-map FILE` makes one", file.string());
  try {
    return read(*bytes);
  } catch (const InputError& e) {
    throw InputError::format("{}: {}", file.string(), e.what());
  }
}

class RunMap : public RunObserver {
 public:
  /// Loads the map of --map. Throws InputError, with the file's name, if that cannot be used or that of --save-map
  /// cannot be written.
  explicit RunMap(RunContext& run) : run_(run), options_(run.options.outputs.get<MapOptions>()) {
    if (!run.config.odometry.map.enabled)
      throw InputError("--map and --save-map need the map: leave out map.enabled=false");
    if (!options_.save.empty() && localize_only())
      throw InputError(
          "--save-map with --localize-only (map.localize_only): the map never changes; leave one of them out");
    if (!options_.save.empty()) check_writable(options_.save, "--save-map", beginning_of_maps());
    if (!options_.load.empty())
      run.products.get<InitialMap>() = {options_.load,
                                        read_map_file(options_.load, [](const std::string& bytes) { return bytes; })};
  }

  void on_step(const Step& step) override {
    // Until localized, --localize-only has no poses, but an estimate that has started.
    if (!first_pose_ && (is_tracking(step.status) || !step.started.empty())) first_pose_ = step.t;
    if (!is_tracking(step.status)) return;
    if (step.relocalized) ++relocalized_;
    if (!options_.load.empty() && !found_ && !run_.awaiting_relocalization) found_ = step.t;
  }

  void on_summary(RunEnd& end) override {
    Figures& figures = end.summary.outputs;
    Json& json = figures.json["map"] = {{"loaded", options_.load.string()},
                                        {"localize_only", localize_only()},
                                        {"found_s", nullptr},
                                        {"relocalized", relocalized_},
                                        {"saved", ""}};
    end.in_map_since = found_;
    if (found_) json["found_s"] = to_seconds(*found_ - *first_pose_);
    if (!options_.load.empty()) add_loaded_line(figures);
    if (!options_.load.empty() && !found_) end.summary.verdict.findings.push_back(not_found());
    if (options_.save.empty()) return;
    map_ = end.save_map();
    if (!map_)
      why_not_ = "this run was not relocalized in that of --map; start where that was made, or leave --map out";
    else if (saved_map_from_bytes(*map_).keyframes.empty())
      why_not_ = "no keyframe has left the window, and a map consists of those; record for longer, and move";
    if (!why_not_.empty()) return;
    json["saved"] = options_.save.string();
    figures.line("map saved", options_.save.string());
  }

  /// Writes the map that is to be kept.
  void on_end(const RunEnd&) override {
    if (options_.save.empty()) return;
    if (!why_not_.empty())
      throw InputError::format("--save-map {}: not written, as {}", options_.save.string(), why_not_);
    write_file(options_.save, *map_);
  }

 private:
  bool localize_only() const { return run_.config.odometry.map.localize_only; }
  void add_loaded_line(Figures& figures) const {
    if (found_)
      figures.line("map", fmt::format("{:.1f} s", to_seconds(*found_ - *first_pose_)),
                   "from the start until relocalized in " + options_.load.string());
    else
      figures.line("map", "not relocalized",
                   localize_only() ? "there are no poses" : "poses are in a frame of their own");
  }

  Finding not_found() const {
    const std::string poses = localize_only() ? "there are no poses" : "the poses are in a frame of their own";
    return {Severity::Error, fmt::format("map: never matched in {}", options_.load.string()),
            poses + ": start where the map was made, facing the same way"};
  }

  const RunContext& run_;
  MapOptions options_;
  std::optional<Timestamp> first_pose_, found_;
  std::size_t relocalized_ = 0;
  std::optional<std::string> map_;  ///< of --save-map
  std::string why_not_;             ///< and how to get one
};

}  // namespace

std::string beginning_of_maps() {
  const std::string empty = to_bytes({});
  return empty.substr(0, empty.find('\n') + 1);
}

SavedMap read_map(const std::filesystem::path& file) { return read_map_file(file, saved_map_from_bytes); }

RunOutput map_output() {
  return {{},
          [](CLI::App& command, Board& options) {
            auto& map = options.get<MapOptions>();
            command.add_option("--map", map.load,
                               "Relocalize in a map of --save-map: poses are in its frame once relocalized");
            command.add_option("--save-map", map.save, "Save the map to this file, which may be that of --map");
          },
          [](RunContext& run) -> std::unique_ptr<RunObserver> {
            const auto& map = run.options.outputs.get<MapOptions>();
            if (run.config.odometry.map.localize_only && map.load.empty())
              throw InputError("--localize-only (map.localize_only) needs the map to localize in: add --map FILE");
            if (map.load.empty() && map.save.empty()) return nullptr;
            return std::make_unique<RunMap>(run);
          }};
}

}  // namespace edged

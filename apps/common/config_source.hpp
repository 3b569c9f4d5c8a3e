// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options of a run from the command line: a file, and single values that override it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/cli.hpp"
#include "edged/autopilot/autopilot_config.hpp"
#include "edged/config.hpp"
#include "edged/live/measurement_queue.hpp"
#include "edged/options.hpp"

namespace edged {

/// Every option of a run.
struct RunConfig {
  OdometryConfig odometry;
  QueueConfig live;  ///< queue of a live run
  AutopilotConfig autopilot;
  void visit(ConfigFields& fields);
};

struct ConfigSource {
  std::filesystem::path file;
  std::vector<std::string> assignments;  ///< "key=value"
};

/// Adds a flag for assignments that may be repeated. what: "One option".
void add_assignments(CLI::App& command, const std::string& flag, const std::string& what,
                     std::vector<std::string>& assignments);

/// Throws InputError that names the key.
template <typename Config>
void assign(Config& config, const std::vector<std::string>& assignments) {
  ConfigFields fields = ConfigFields::of(config);
  for (const std::string& assignment : assignments) fields.set(assignment);
}

/// Adds --config and --set.
void add_config_options(CLI::App& command, ConfigSource& source);

/// Throws InputError that names the file and line, or the key.
RunConfig load_config(const ConfigSource& source);

/// The configuration as yaml.
std::string options_text(RunConfig config);

}  // namespace edged

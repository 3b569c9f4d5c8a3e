// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/config_source.hpp"

#include <CLI/CLI.hpp>

namespace edged {

void RunConfig::visit(ConfigFields& fields) {
  odometry.visit(fields);
  fields.group("live", live);
  fields.group("autopilot", autopilot);
}

void add_assignments(CLI::App& command, const std::string& flag, const std::string& what,
                     std::vector<std::string>& assignments) {
  command.add_option(flag, assignments, what + " as key=value; may be repeated")->allow_extra_args(false);
}

void add_config_options(CLI::App& command, ConfigSource& source) {
  command.add_option("--config", source.file, "Options file (YAML); `edged config --yaml` prints one");
  add_assignments(command, "--set", "One option", source.assignments);
}

RunConfig load_config(const ConfigSource& source) {
  RunConfig config;
  if (!source.file.empty()) ConfigFields::of(config).load(source.file);
  assign(config, source.assignments);
  return config;
}

std::string options_text(RunConfig config) { return ConfigFields::of(config).to_yaml(); }

}  // namespace edged

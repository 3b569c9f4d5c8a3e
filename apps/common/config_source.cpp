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

void add_config_options(CLI::App& command, ConfigSource& source) {
  command.add_option("--config", source.file, "Options file (YAML); `edged config --yaml` prints one");
  command.add_option("--set", source.assignments, "One option as key=value; may be repeated")->allow_extra_args(false);
}

RunConfig load_config(const ConfigSource& source) {
  RunConfig config;
  ConfigFields fields = ConfigFields::of(config);
  if (!source.file.empty()) fields.load(source.file);
  for (const std::string& assignment : source.assignments) fields.set(assignment);
  return config;
}

std::string options_text(RunConfig config) { return ConfigFields::of(config).to_yaml(); }

}  // namespace edged

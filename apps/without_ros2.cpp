// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The commands for ROS 2 in a program that was built without Cyclone DDS: they say so.
#include <CLI/CLI.hpp>

#include "edged/core/check.hpp"
#include "program/commands.hpp"

namespace edged {
namespace {

void add_absent(CLI::App& app, std::function<int()>& chosen, const char* name, const char* what) {
  CLI::App* command = app.add_subcommand(name, what);
  command->allow_extras();
  command->callback([name, &chosen] {
    chosen = [name]() -> int {
      throw InputError::format(
          "`edged {}` is not in this program: install cyclonedds-dev (Debian), configure and build again", name);
    };
  });
}

}  // namespace

void add_ros2_command(CLI::App& app, std::function<int()>& chosen) {
  add_absent(app, chosen, "ros2", "Run on topics of ROS 2 (not in this program: Cyclone DDS was missing)");
}

void add_play_command(CLI::App& app, std::function<int()>& chosen) {
  add_absent(app, chosen, "play", "Play a recording as topics of ROS 2 (not in this program: Cyclone DDS was missing)");
}

}  // namespace edged

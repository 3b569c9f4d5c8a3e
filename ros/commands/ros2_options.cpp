// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "commands/ros2_options.hpp"

#include <CLI/CLI.hpp>

namespace edged {

void add_ros2_place(CLI::App& command, Ros2Place& place, const std::string& node) {
  place.node = node;
  command.add_option("--domain", place.domain, "DDS domain, instead of ROS_DOMAIN_ID")->check(CLI::Range(0, 232));
  command.add_option("--namespace", place.name_space, "Namespace of the topics [/]");
  command.add_option("--node", place.node, "Name of the node [" + node + "]");
  command
      .add_option("-r,--remap", place.remappings,
                  "Another topic, as from:=to, e.g. events:=/event_camera/events; may be repeated")
      ->allow_extra_args(false);
}

ros2::Discovery discovery_of(const Ros2Place& place) {
  ros2::Discovery discovery = ros2::discovery_of();
  if (place.domain) discovery.domain = *place.domain;
  return discovery;
}

ros2::Names names_of(const Ros2Place& place) { return {place.name_space, place.node, place.remappings}; }

}  // namespace edged

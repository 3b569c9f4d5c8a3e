// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options of `edged ros2` and `edged play` that say where in the graph of ROS 2 they are.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/cli_fwd.hpp"
#include "dds/environment.hpp"
#include "dds/names.hpp"

namespace edged {

struct Ros2Place {
  std::optional<std::uint32_t> domain;  ///< instead of ROS_DOMAIN_ID
  std::string name_space = "/", node;
  std::vector<std::string> remappings;
};

/// Adds --domain, --namespace, --node and -r, --remap. node: the default name.
void add_ros2_place(CLI::App& command, Ros2Place& place, const std::string& node);

/// From the environment, and the domain of the command line.
ros2::Discovery discovery_of(const Ros2Place& place);
ros2::Names names_of(const Ros2Place& place);

}  // namespace edged

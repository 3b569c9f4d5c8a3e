// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The arguments that every node of ROS 2 takes, behind --ros-args, so that `ros2 launch` can start the program.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/cli.hpp"
#include "edged/config.hpp"

namespace edged {

struct RosArguments {
  bool begin = false;                        ///< --ros-args, which changes nothing
  std::vector<std::string> parameters;       ///< "name:=value"
  std::vector<std::filesystem::path> files;  ///< of parameters
  std::string log_level, enclave;

  /// Whether only warnings are to be logged.
  bool quiet() const { return log_level == "warn" || log_level == "error" || log_level == "fatal"; }
};

/// Adds --ros-args, -p, --params-file, --log-level and --enclave.
void add_ros_arguments(CLI::App& command, RosArguments& arguments);

/// Sets the parameters of the node, first those of the files. node: its full name, "/robot/edged". Throws InputError
/// that names file or parameter.
void set_parameters(ConfigFields& fields, const RosArguments& arguments, const std::string& node);

}  // namespace edged

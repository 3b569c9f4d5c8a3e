// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "commands/ros_arguments.hpp"

#include <yaml-cpp/yaml.h>
#include <CLI/CLI.hpp>

#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr const char* kParameters = "ros__parameters";

void set_tree(ConfigFields& fields, const YAML::Node& tree, const std::string& group) {
  for (const auto& entry : tree) {
    const std::string key = group + entry.first.as<std::string>();
    if (entry.second.IsMap()) {
      set_tree(fields, entry.second, key + ".");
    } else if (entry.second.IsScalar()) {
      fields.set(key, entry.second.as<std::string>());
    } else {
      throw InputError::format("parameter {}: must be one value", key);
    }
  }
}

/// Whether a name of a parameter file, "/robot/edged", "edged", "/**" or "**", is that of the node.
bool is_of(const std::string& name, const std::string& node) {
  return name == "/**" || name == "**" || "/" + name == node || name == node;
}

/// place: the name of `tree`, without a slash at its end.
void set_nodes(ConfigFields& fields, const YAML::Node& tree, const std::string& place, const std::string& node) {
  for (const auto& entry : tree) {
    const auto name = entry.first.as<std::string>();
    if (name == kParameters) {
      if (is_of(place, node)) set_tree(fields, entry.second, "");
    } else if (entry.second.IsMap()) {
      set_nodes(fields, entry.second, place.empty() ? name : place + "/" + name, node);
    }
  }
}

void set_file(ConfigFields& fields, const std::filesystem::path& file, const std::string& node) {
  try {
    const YAML::Node tree = YAML::LoadFile(file.string());
    if (!tree.IsMap()) throw InputError::format("no map of nodes with {}", kParameters);
    set_nodes(fields, tree, "", node);
  } catch (const YAML::BadFile&) {
    throw InputError::format("--params-file {}: cannot be read", file.string());
  } catch (const std::exception& error) {  // of the parser, or of an option
    throw InputError::format("--params-file {}: {}", file.string(), error.what());
  }
}

}  // namespace

void add_ros_arguments(CLI::App& command, RosArguments& arguments) {
  command.add_flag("--ros-args", arguments.begin, "Begins the arguments of a ROS node; changes nothing");
  command.add_option("-p,--param", arguments.parameters, "One option, as ROS has it: name:=value; may be repeated")
      ->allow_extra_args(false);
  command.add_option("--params-file", arguments.files, "Options of a parameter file of ROS (ros__parameters)")
      ->allow_extra_args(false);
  command.add_option("--log-level", arguments.log_level, "From warn on only warnings are shown")
      ->check(CLI::IsMember({"debug", "info", "warn", "error", "fatal"}));
  command.add_option("--enclave", arguments.enclave, "Not used: there is no DDS Security");
}

void set_parameters(ConfigFields& fields, const RosArguments& arguments, const std::string& node) {
  for (const std::filesystem::path& file : arguments.files) set_file(fields, file, node);
  for (const std::string& parameter : arguments.parameters) {
    const std::size_t sign = parameter.find(":=");
    if (sign == std::string::npos)
      throw InputError::format("parameter '{}': write it as name:=value, such as mode:=events", parameter);
    fields.set(parameter.substr(0, sign), parameter.substr(sign + 2));
  }
}

}  // namespace edged

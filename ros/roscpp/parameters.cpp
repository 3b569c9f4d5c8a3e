// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "roscpp/parameters.hpp"

#include <algorithm>

#include "edged/core/check.hpp"

namespace edged::ros1 {
namespace {

using XmlRpc::XmlRpcValue;

std::string text_of(XmlRpcValue& value) {
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      return static_cast<bool>(value) ? "true" : "false";
    case XmlRpcValue::TypeInt:
      return std::to_string(static_cast<int>(value));
    case XmlRpcValue::TypeDouble:
      return fmt::format("{}", static_cast<double>(value));
    case XmlRpcValue::TypeString:
      return static_cast<std::string>(value);
    default:
      throw InputError("it must be one value, not a list");
  }
}

/// path: of `tree`, with a slash at its end unless it is empty.
void set_tree(ConfigFields& fields, XmlRpcValue& tree, const std::string& path) {
  for (auto& [name, value] : tree) {
    if (value.getType() == XmlRpcValue::TypeStruct) {
      set_tree(fields, value, path + name + "/");
      continue;
    }
    std::string key = path + name;
    std::ranges::replace(key, '/', '.');
    try {
      fields.set(key, text_of(value));
    } catch (const InputError& e) {
      throw InputError::format("parameter ~{}{}: {}", path, name, e.what());
    }
  }
}

/// Where the options of the odometry are a group.
struct Tree {
  node::NodeConfig& config;
  void visit(ConfigFields& fields) {
    config.visit_node(fields);
    fields.group("options", config.options);
  }
};

}  // namespace

void set_parameters(node::NodeConfig& config, XmlRpcValue parameters) {
  Tree tree{config};
  ConfigFields fields = ConfigFields::of(tree);
  if (parameters.getType() == XmlRpcValue::TypeStruct) set_tree(fields, parameters, "");
  if (config.rig.empty())
    throw InputError("parameter ~rig is missing: give the name of a rig that ships, or a calibration file");
  try {
    config.options.validate();
  } catch (const InputError& e) {
    throw InputError::format("parameters ~options: {}", e.what());
  }
}

}  // namespace edged::ros1

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node_config.hpp"

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

}  // namespace

void NodeConfig::visit(ConfigFields& fields) {
  fields.add("rig", rig, {"", 0, 0, "name of a rig that ships, or a calibration file"});
  fields.choice("mode", mode, {{"events", Mode::Events}, {"frames", Mode::Frames}, {"fused", Mode::Fused}},
                {"", 0, 0, "which cameras beside the IMU"});
  fields.add("world_frame", frames.world, {"", 0, 0, "name of the world in tf and headers"});
  fields.add("body_frame", frames.body,
             {"", 0, 0, "name of the body, which is the IMU; cameras have those of the rig"});
  fields.add("publish_tf", publish_tf, {"", 0, 0, "send transforms of body and cameras"});
  fields.add("delays.events_s", delays.events_s, {"s", 0, 10, "events may lag this far behind the other sensors"});
  fields.add("delays.frames_s", delays.frames_s, {"s", 0, 10, "as delays.events_s"});
  fields.add("delays.imu_s", delays.imu_s, {"s", 0, 10, "as delays.events_s"});
  fields.add("delays.external_s", delays.external_s,
             {"s", 0, 10, "height and velocity samples may lag this far behind the other sensors"});
  fields.add("max_age_s", max_age_s,
             {"s", 0.05, 3600, "when the odometry lags so far behind, events are left out; frames at twice that"});
  fields.add("path_step_s", path_step_s, {"s", 0.001, 3600, "between poses of the path"});
  fields.group("options", options);
}

void set_parameters(NodeConfig& config, XmlRpcValue parameters) {
  ConfigFields fields = ConfigFields::of(config);
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

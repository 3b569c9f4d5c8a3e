// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/outputs.hpp"

namespace edged::node {
namespace {

constexpr std::size_t kImageQueue = 2, kDiagnosticsQueue = 100;  // messages that may wait for a slow subscriber

}  // namespace

Outputs::Outputs(Transport& transport, const NodeConfig& config, const std::optional<SE3>& T_base_B)
    : transport_(transport),
      format_{transport.wire(), config.frame_names()},
      poses_(transport, config, T_base_B),
      map_(transport, config),
      diagnostics_(transport.advertise({"/diagnostics", "diagnostic_msgs/DiagnosticArray", kDiagnosticsQueue})) {}

void Outputs::add_camera(const std::string& name, const std::string& topic) {
  tracks_[name] = transport_.advertise({"~/tracks/" + topic, "sensor_msgs/Image", kImageQueue});
}

void Outputs::publish(const Step& step, const std::optional<Estimate>& base, const SE3& T_map_odom) {
  publish_images(step);
  if (!is_tracking(step.status)) return;
  if (base) poses_.publish(*base, T_map_odom);
  map_.publish(step);
}

void Outputs::publish_images(const Step& step) const {
  for (const CameraStep& camera : step.cameras) {
    const auto topic = tracks_.find(camera.name);
    if (topic != tracks_.end() && !camera.image.empty() && topic->second->wanted())
      topic->second->publish(tracks_message(format_, step.t, camera));
  }
}

void Outputs::publish(const Diagnosis& diagnosis, const std::string& hardware) const {
  diagnostics_->publish(diagnostics_message(transport_.wire(), transport_.now(), hardware, diagnosis));
}

}  // namespace edged::node

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/autopilot_outputs.hpp"

#include "edged/core/check.hpp"
#include "node/messages.hpp"

namespace edged::node {

AutopilotOutputs::AutopilotOutputs(Transport& transport, const NodeConfig& config) : stream_(config.autopilot) {
  if (!config.mavlink.empty()) mavlink_ = std::make_unique<MavlinkOutput>(config.mavlink, config.autopilot);
  if (!config.publish_px4) return;
  if (transport.wire() != Wire::Cdr) throw InputError("publish_px4: PX4 has topics of ROS 2 only: use mavlink");
  px4_ = transport.advertise({"/fmu/in/vehicle_visual_odometry", "px4_msgs/VehicleOdometry", 1, false, false});
}

void AutopilotOutputs::note(const Step& step) {
  if (mavlink_) mavlink_->note(step);
  const std::lock_guard lock(mutex_);
  stream_.note(step);
}

void AutopilotOutputs::send(const NavState& state, const ImuSample& sample) {
  if (!mavlink_ && !px4_) return;
  clock_.arrived(sample.t, MavlinkOutput::unix_now());
  const Duration now = clock_.at(state.t);
  if (mavlink_) mavlink_->send(state, sample.gyro_B, now);
  if (!px4_) return;
  std::optional<VehicleOdometry> odometry;
  {
    const std::lock_guard lock(mutex_);
    odometry = stream_.next(state, sample.gyro_B, now);
  }
  if (odometry) px4_->publish(vehicle_odometry_message(*odometry));
}

}  // namespace edged::node

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The state at IMU samples for an autopilot: over MAVLink, and as the topic of PX4.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "edged/autopilot/arrival_clock.hpp"
#include "edged/autopilot/mavlink_output.hpp"
#include "edged/autopilot/vehicle_stream.hpp"
#include "node/node_config.hpp"
#include "node/transport.hpp"

namespace edged::node {

/// Steps come from one thread, states from another.
class AutopilotOutputs {
 public:
  /// Throws InputError where config.mavlink cannot be opened, config.autopilot is wrong, or ROS 1 is to have PX4's
  /// topic.
  AutopilotOutputs(Transport& transport, const NodeConfig& config);

  /// Each step, in order.
  void note(const Step& step);
  /// A state predicted to an IMU sample that has just arrived. Sent at the rate of the options.
  void send(const NavState& state, const ImuSample& sample);

 private:
  std::unique_ptr<MavlinkOutput> mavlink_;
  std::unique_ptr<Publisher> px4_;
  ArrivalClock clock_;

  std::mutex mutex_;  // of what PX4 gets
  VehicleStream stream_;
};

}  // namespace edged::node

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The diagnostics of the node in one message: status, reason, and counters of measurements.
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>

#include <map>
#include <optional>
#include <string>

#include "backlog.hpp"
#include "edged/odometry.hpp"
#include "sensor_input.hpp"

namespace edged::ros1 {

struct NodeHealth {
  std::optional<TrackingStatus> status;         ///< of the newest step
  std::string reason;                           ///< what initialization waits for, or what ended the last estimate
  std::map<std::string, InputCounters> inputs;  ///< by topic
  OdometryCounters odometry;
  BacklogCounters left_out;
  std::size_t newly_lost = 0;   ///< of lost_measurements, since the last report
  std::optional<Duration> age;  ///< from the newest step to the newest measurement
};

/// Measurements that are in no packet: unreadable, invalid, late, dropped, without room.
std::size_t lost_measurements(const NodeHealth& health);

/// A warning unless the status is Good and nothing was newly lost. hardware: the rig's name.
diagnostic_msgs::DiagnosticStatus diagnostics_message(const NodeHealth& health, const std::string& hardware);

}  // namespace edged::ros1

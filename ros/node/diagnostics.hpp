// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The diagnostics of the node: status, reason, and counters of measurements.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "edged/live/measurement_queue.hpp"
#include "edged/odometry.hpp"
#include "topics/sensor_input.hpp"

namespace edged::node {

struct NodeHealth {
  std::optional<TrackingStatus> status;         ///< status of the newest step
  std::string reason;                           ///< what initialization waits for, or what ended the last estimate
  std::map<std::string, InputCounters> inputs;  ///< by topic
  OdometryCounters odometry;
  DropCounters dropped;            ///< too slow for them
  std::size_t wrong_clocks = 0;    ///< topics whose stamps run at another speed
  bool imu_clock_unknown = false;  ///< its offset is searched
  std::string missing_transform;   ///< without which no pose is published; "" if none
  std::string request;             ///< the last one, and its result; "" if none
  std::size_t newly_lost = 0;      ///< rise of lost_measurements since the last report
  std::optional<Duration> age;     ///< from the newest step to the newest IMU sample
};

/// Measurements that are in no packet: unreadable, invalid, late, dropped, without room.
std::size_t lost_measurements(const NodeHealth& health);

/// The content of a diagnostic_msgs/DiagnosticStatus.
struct Diagnosis {
  enum class Level : std::uint8_t { Ok = 0, Warning = 1, Error = 2 };
  Level level = Level::Ok;
  std::string message;
  std::vector<std::pair<std::string, std::string>> values;
};

/// A warning unless the status is Good, nothing was newly lost and nothing is wrong with a topic.
Diagnosis diagnose(const NodeHealth& health);

}  // namespace edged::node

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Sends the odometry to an autopilot as MAVLink: ODOMETRY at a steady rate, a heartbeat, and the answers to TIMESYNC.
#pragma once

#include <cstddef>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include "edged/autopilot/autopilot_config.hpp"
#include "edged/autopilot/mavlink.hpp"
#include "edged/autopilot/mavlink_port.hpp"
#include "edged/autopilot/vehicle_stream.hpp"

namespace edged {

struct MavlinkCounters {
  std::size_t odometry = 0;    ///< messages sent
  std::size_t heartbeats = 0;  ///< messages sent
  std::size_t timesyncs = 0;   ///< requests answered
  std::size_t dropped = 0;     ///< messages of all kinds that the line did not take
};

/// From any thread. No call waits for the line. A message that it does not take is dropped and counted; the first one
/// is reported in the log with the reason.
class MavlinkOutput {
 public:
  /// url: that of MavlinkPort. Throws InputError where it cannot be opened, or config.axes is no mounting.
  MavlinkOutput(const std::string& url, const AutopilotConfig& config);

  /// Each step, in order.
  void note(const Step& step);

  /// A state predicted from the newest step, the IMU sample at its time, and this time by the clock of this machine
  /// since the Unix epoch. Sends it if it is due, and returns whether it was.
  bool send(const NavState& state, const Eigen::Vector3d& gyro_B, Duration unix_time);

  MavlinkCounters counters() const;

  /// The clock of this machine, with which messages are stamped and TIMESYNC is answered.
  static Duration unix_now();

 private:
  void put(const MavlinkFrame& frame, std::size_t& counter);
  void serve(const std::stop_token& stop);

  const std::string url_;

  mutable std::mutex mutex_;  ///< guards all below but the thread
  MavlinkPort port_;          ///< the thread waits and receives
  MavlinkEncoder encoder_;
  VehicleStream stream_;
  MavlinkCounters counters_;

  std::jthread thread_;  ///< last: it uses the others
};

}  // namespace edged

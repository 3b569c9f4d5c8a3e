// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The messages for an autopilot at the rate of the options, stamped by the clock of this machine.
#pragma once

#include <optional>

#include "edged/autopilot/autopilot_config.hpp"
#include "edged/autopilot/rate_limit.hpp"
#include "edged/autopilot/vehicle_tracker.hpp"

namespace edged {

/// Not synchronized.
class VehicleStream {
 public:
  /// Throws InputError where config.axes is no mounting.
  explicit VehicleStream(const AutopilotConfig& config) : tracker_(config.R_V_B()), rate_(config.rate_hz) {}

  /// Each step, in order.
  void note(const Step& step) { tracker_.note(step); }

  /// Of a state predicted from the newest step, the IMU sample at its time, and this time by the clock of this machine
  /// since the Unix epoch. Nothing without a pose, or if no message is due.
  std::optional<VehicleOdometry> next(const NavState& state, const Eigen::Vector3d& gyro_B, Duration unix_time) {
    std::optional<VehicleOdometry> odometry = tracker_.at(state, gyro_B);
    if (!odometry || !rate_.is_due(state.t)) return std::nullopt;
    odometry->timestamp = odometry->timestamp_sample =
        static_cast<std::uint64_t>(unix_time / std::chrono::microseconds(1));
    return odometry;
  }

 private:
  VehicleTracker tracker_;
  RateLimit rate_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The messages for an autopilot at the rate of the options, stamped by the clock of this machine.
#pragma once

#include <optional>

#include "edged/autopilot/autopilot_config.hpp"
#include "edged/autopilot/vehicle_tracker.hpp"

namespace edged {

/// Lets states through on average at the rate, whatever that of the stream; also after a pause, and after a clock that
/// jumped back.
class RateLimit {
 public:
  explicit RateLimit(double rate_hz) : period_(duration_from_seconds(1.0 / rate_hz)) {}

  /// Whether the state at t is to be sent.
  bool is_due(Timestamp t) {
    if (next_ && t < *next_ && *next_ - t <= period_) return false;
    const bool steady = next_ && t >= *next_ && t - *next_ < period_;
    next_ = (steady ? *next_ : t) + period_;
    return true;
  }

 private:
  Duration period_;
  std::optional<Timestamp> next_;
};

/// Not synchronized.
class VehicleStream {
 public:
  /// Throws InputError where config.axes is no mounting.
  explicit VehicleStream(const AutopilotConfig& config) : tracker_(config.R_V_B()), rate_(config.rate_hz) {}

  /// Each step, in order.
  void note(const Step& step) { tracker_.note(step); }

  /// The message for a state predicted from the newest step. gyro_B: of the IMU sample at its time [rad/s]; unix_time:
  /// that time by the clock of this machine. Nothing without a pose, or if no message is due.
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

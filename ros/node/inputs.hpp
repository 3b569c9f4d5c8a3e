// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The topics that the node subscribes to, and what waits for the odometry.
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "edged/checks/found_imu_clock.hpp"
#include "edged/live/event_thinner.hpp"
#include "edged/live/measurement_queue.hpp"
#include "node/diagnostics.hpp"
#include "topics/clock_check.hpp"
#include "topics/sensor_input.hpp"
#include "topics/stamp_clock.hpp"
#include "topics/transport.hpp"

namespace edged::node {

/// Threads of the transport decode messages and queue the measurements. While the odometry is too slow for them, events
/// are thinned and dropped, and frames later, as in `edged run --live`; IMU samples never.
class Inputs {
 public:
  /// on_imu: called in a thread of the transport with each sample as it arrives.
  Inputs(Transport& transport, double max_age_s, std::function<void(const ImuSample&)> on_imu);

  /// For an IMU with an epoch of its own. Before start() of the transport.
  void set_imu_clock(LiveImuClock clock) { imu_clock_.emplace(std::move(clock)); }

  /// Throws InputError when two sensors have one topic.
  void subscribe(const std::string& topic, Role role, const std::string& camera);

  /// The oldest measurement; waits for one, at most so long. Rethrows what went wrong in a thread of the transport.
  std::optional<Measurement> next(std::chrono::milliseconds longest);
  /// Nothing more is wanted: no thread of the transport waits for room.
  void interrupt() { queue_.interrupt(); }

  /// StampClock::set_by
  Duration clock_set_by() const { return stamps_.set_by(); }
  /// Fills in what is known of topics and dropped measurements.
  void describe(NodeHealth& health) const;

 private:
  void on_message(const std::string& topic, SensorInput& input, const WireMessage& message);
  void queue(const std::string& topic, Measurement measurement);

  Transport& transport_;
  const std::function<void(const ImuSample&)> on_imu_;
  MeasurementQueue queue_;
  OverloadThinner thinner_;
  std::optional<ClockCheck> clocks_;
  StampClock stamps_;
  mutable std::mutex order_;                   ///< of measurements of a topic, which another may release
  std::optional<LiveImuClock> imu_clock_;      ///< of one with an epoch of its own; guarded by that
  std::map<std::string, SensorInput> inputs_;  ///< by topic; not changed after start() of the transport
  std::mutex mutex_;
  std::exception_ptr failure_;  ///< the first one of a thread of the transport; guarded by the mutex
};

}  // namespace edged::node

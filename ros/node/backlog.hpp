// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Drops events and frames while the odometry is too slow for them.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>

#include "edged/measurement.hpp"

namespace edged::node {

/// Counters of dropped measurements.
struct BacklogCounters {
  std::size_t events = 0, frames = 0;
};

/// Late poses are worth less than those from fewer events: while the odometry works and its newest step is more than
/// max_age_s behind the newest measurement, events are dropped; at twice that frames, which have more information and
/// cost less; IMU samples never. While it waits for a sensor that lags or is silent, nothing is dropped. From any
/// thread.
class Backlog {
 public:
  explicit Backlog(double max_age_s);

  /// Whether it is to be added.
  bool admit(const Measurement& measurement);
  /// The odometry has made a step at t and goes on working.
  void note_step(Timestamp t);
  /// It has processed all that it could.
  void note_idle();
  BacklogCounters counters() const;
  /// From the newest step to the newest measurement.
  std::optional<Duration> age() const;

 private:
  const Duration max_age_;
  mutable std::mutex mutex_;
  bool working_ = false;
  std::optional<Timestamp> newest_, step_;
  BacklogCounters counters_;
};

}  // namespace edged::node

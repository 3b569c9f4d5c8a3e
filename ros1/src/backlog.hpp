// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Leaves out events and frames while the odometry is too slow for them.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>

#include "edged/measurement.hpp"

namespace edged::ros1 {

/// What was left out.
struct BacklogCounters {
  std::size_t events = 0, frames = 0;
};

/// Late poses are worth less than those from fewer events: while the odometry works and its newest step lies more than
/// max_age_s behind what comes, events are left out; at twice that frames, which stand for more and cost less. IMU
/// samples never. While it waits, for a sensor that lags or is silent, nothing is left out. From any thread.
class Backlog {
 public:
  explicit Backlog(double max_age_s);

  /// Whether it is to be added.
  bool admit(const Measurement& measurement);
  /// The odometry has made a step at t and goes on working.
  void note_step(Timestamp t);
  /// It has worked up all that it could.
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

}  // namespace edged::ros1

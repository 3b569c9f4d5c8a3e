// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Maps the clock of measurements to the wall clock: when each is due.
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>

#include "edged/live/arrival_clock.hpp"

namespace edged {

/// Measurements of a recording are due at its speed, those of sensors when they come: their clock drifts.
enum class Due { BySpeed, OnArrival };

class LiveClock {
 public:
  using Clock = std::chrono::steady_clock;

  explicit LiveClock(Due due = Due::BySpeed, std::function<Clock::time_point()> now = Clock::now)
      : due_(due), now_(std::move(now)) {}

  /// Sleeps until t is due, relative to the first t; not for what arrives, which is due now. Polls `stopped`, and
  /// returns early when that is true. Returns when it was due.
  Clock::time_point wait_for(Timestamp t, const std::function<bool()>& stopped);

  /// Time since t was due [s], negative before; 0 before the first wait_for. Of what arrives: since it would have come
  /// with the least delay of the last seconds. For threads that get the measurement from the one that waited.
  double since_due_s(Timestamp t) const;

 private:
  Clock::time_point due(Timestamp t) const;

  const Due due_;
  const std::function<Clock::time_point()> now_;
  mutable std::mutex mutex_;
  ArrivalClock arrivals_;           // guarded by that
  std::optional<Timestamp> first_;  // written once, by the first wait_for
  Clock::time_point begin_;
};

}  // namespace edged

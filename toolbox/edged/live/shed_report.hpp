// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// When to report to the user that shedding begins and ends.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "edged/live/measurement_queue.hpp"

namespace edged {

/// One line when shedding begins and one when nothing has been shed for a second, at most one pair in ten seconds;
/// earlier shedding is counted in the next.
class ShedReport {
 public:
  using Clock = std::chrono::steady_clock;

  /// The line that is due, if any. `total` as counted since the beginning.
  std::optional<std::string> update(const ShedCounters& total, Clock::time_point now);

 private:
  std::optional<Clock::time_point> said_;  // time of the last line on a beginning
  bool telling_ = false;                   // a beginning has been reported, its end has not
  Clock::time_point last_shed_;
  ShedCounters seen_, told_;  // by now; up to the last reported end
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// When to tell the user that measurements are left out, and that it is over.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "edged/live/measurement_queue.hpp"

namespace edged {

/// One line when shedding begins and one when nothing has been shed for a second, of one bout in ten seconds; what
/// comes sooner is counted in the next.
class ShedReport {
 public:
  using Clock = std::chrono::steady_clock;

  /// The line that is due, if any. `total` as counted since the beginning.
  std::optional<std::string> update(const ShedCounters& total, Clock::time_point now);

 private:
  std::optional<Clock::time_point> said_;  // of the last line that told of a beginning
  bool telling_ = false;                   // a beginning has been told, its end has not
  Clock::time_point last_shed_;
  ShedCounters seen_, told_;  // by now; up to the last end told
};

}  // namespace edged

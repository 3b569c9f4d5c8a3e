// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// When to report to the user that measurements are dropped, and no longer.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "edged/live/measurement_queue.hpp"

namespace edged {

/// One line when dropping begins and one when nothing has been dropped for a second, at most one pair in ten seconds;
/// what is dropped between is counted in the next.
class DropReport {
 public:
  using Clock = std::chrono::steady_clock;

  /// The line that is due, if any. total: dropped since the beginning.
  std::optional<std::string> update(const DropCounters& total, Clock::time_point now);

 private:
  std::optional<Clock::time_point> begin_;  // time of the last line on a beginning
  bool dropping_ = false;                   // a beginning has been reported, its end has not
  Clock::time_point last_drop_;
  DropCounters total_, reported_;  // by now; up to the last reported end
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording's clock tied to the wall clock, for a run at the recording's own speed.
#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "edged/time.hpp"

namespace edged {

class LiveClock {
 public:
  /// Sleeps until t is due: as long after the first t as its stamp says. Asks `stopped` now and then, and ends early
  /// when it says so.
  void wait_for(Timestamp t, const std::function<bool()>& stopped);

  /// Since t was due [s], negative before; 0 when nothing has been waited for. Of a thread that has the measurement
  /// from the one that waited for it.
  double since_due_s(Timestamp t) const;

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point due(Timestamp t) const { return begin_ + (t - *first_); }

  std::optional<Timestamp> first_;  // written once, by the first wait_for
  Clock::time_point begin_;
};

}  // namespace edged

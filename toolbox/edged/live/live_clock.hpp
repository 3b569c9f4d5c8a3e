// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Maps a recording's clock to the wall clock, for a run at the speed of the recording.
#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "edged/time.hpp"

namespace edged {

class LiveClock {
 public:
  using Clock = std::chrono::steady_clock;

  /// Sleeps until t is due, relative to the first t. Polls `stopped`, and returns early when that is true.
  void wait_for(Timestamp t, const std::function<bool()>& stopped);

  /// Time since t was due [s], negative before; 0 before the first wait_for. For threads that get the measurement from
  /// the one that waited.
  double since_due_s(Timestamp t) const;

  /// When t is due. After the first wait_for.
  Clock::time_point due(Timestamp t) const { return begin_ + (t - *first_); }

 private:
  std::optional<Timestamp> first_;  // written once, by the first wait_for
  Clock::time_point begin_;
};

}  // namespace edged

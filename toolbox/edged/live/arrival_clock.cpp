// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/arrival_clock.hpp"

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {

void ArrivalClock::arrived(Timestamp t, Duration now) {
  constexpr Duration kSpan = std::chrono::seconds(10);
  constexpr Duration kOutOfOrder = std::chrono::seconds(1);  // a sample that is farther back is of another time
  if (!is_plausible(t)) return;
  const bool first = newest_ == Timestamp::min();
  if (!first && t < newest_ && newest_ - t < kOutOfOrder) return;
  if (first || t < newest_) {
    begin_ = t;
    least_ = least_before_ = Duration::max();
  } else if (t - begin_ >= kSpan) {
    begin_ = t;
    least_before_ = least_;
    least_ = Duration::max();
  }
  newest_ = t;
  least_ = std::min(least_, now - t.time_since_epoch());
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/autopilot/arrival_clock.hpp"

namespace edged {

void ArrivalClock::arrived(Timestamp t, Duration now) {
  constexpr Duration kSpan = std::chrono::seconds(10);
  const bool first = newest_ == Timestamp::min();
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

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/live_clock.hpp"

#include <algorithm>
#include <thread>

namespace edged {

void LiveClock::wait_for(Timestamp t, const std::function<bool()>& stopped) {
  constexpr auto kLongestSleep = std::chrono::milliseconds(50);  // a stop waits no longer
  if (!first_) begin_ = Clock::now(), first_ = t;
  while (Clock::now() < due(t) && !stopped())
    std::this_thread::sleep_for(std::min<Clock::duration>(due(t) - Clock::now(), kLongestSleep));
}

double LiveClock::since_due_s(Timestamp t) const {
  return first_ ? std::chrono::duration<double>(Clock::now() - due(t)).count() : 0.0;
}

}  // namespace edged

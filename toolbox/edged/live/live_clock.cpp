// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/live_clock.hpp"

#include <algorithm>
#include <thread>

namespace edged {

LiveClock::Clock::time_point LiveClock::wait_for(Timestamp t, const std::function<bool()>& stopped) {
  constexpr auto kLongestSleep = std::chrono::milliseconds(50);  // a stop waits no longer
  if (!first_) begin_ = now_(), first_ = t;
  if (due_ == Due::OnArrival) {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = now_();
    arrivals_.arrived(t, now.time_since_epoch());
    return now;
  }
  while (now_() < due(t) && !stopped())
    std::this_thread::sleep_for(std::min<Clock::duration>(due(t) - now_(), kLongestSleep));
  return due(t);
}

LiveClock::Clock::time_point LiveClock::due(Timestamp t) const {
  if (due_ == Due::BySpeed) return begin_ + (t - *first_);
  const std::lock_guard lock(mutex_);
  return Clock::time_point(arrivals_.at(t));
}

double LiveClock::since_due_s(Timestamp t) const {
  return first_ ? std::chrono::duration<double>(now_() - due(t)).count() : 0.0;
}

}  // namespace edged

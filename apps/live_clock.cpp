// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "live_clock.hpp"

#include <algorithm>
#include <thread>

#include "edged/core/statistics.hpp"
#include "interrupt.hpp"

namespace edged {

LiveClock::Clock::time_point LiveClock::due(Timestamp t) const { return begin_ + (t - *first_); }

void LiveClock::wait_for(std::optional<Timestamp> t) {
  if (!t) return;
  constexpr auto kLongestSleep = std::chrono::milliseconds(50);  // an interrupt waits no longer
  if (!first_) first_ = *t, begin_ = Clock::now();
  while (interrupt_signal() == 0 && Clock::now() < due(*t))
    std::this_thread::sleep_for(std::min<Clock::duration>(due(*t) - Clock::now(), kLongestSleep));
}

void LiveClock::note_result(Timestamp t) {
  if (first_) latencies_s_.push_back(std::chrono::duration<double>(Clock::now() - due(t)).count());
}

double LiveClock::median_latency_s() const { return median(latencies_s_); }

double LiveClock::worst_latency_s() const {
  return latencies_s_.empty() ? 0.0 : *std::max_element(latencies_s_.begin(), latencies_s_.end());
}

}  // namespace edged

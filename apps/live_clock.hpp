// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording's clock tied to the wall clock, for a run at the recording's own speed.
#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "edged/core/types.hpp"

namespace edged {

class LiveClock {
 public:
  /// Sleeps until t is due: as long after the first t as its stamp says; nothing is always due. Ends early when the
  /// user interrupts.
  void wait_for(std::optional<Timestamp> t);

  /// What was measured until t has been worked up now.
  void note_result(Timestamp t);

  /// From a measurement's due time to its result [s]; 0 for no results.
  double median_latency_s() const;
  double worst_latency_s() const;

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point due(Timestamp t) const;

  std::optional<Timestamp> first_;
  Clock::time_point begin_;
  std::vector<double> latencies_s_;
};

}  // namespace edged

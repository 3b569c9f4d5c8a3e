// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording played at its own speed by a thread of its own, as sensors would: who is too slow for it misses events.
#pragma once

#include <functional>
#include <optional>

#include "edged/dataset.hpp"
#include "edged/live/live_clock.hpp"
#include "edged/live/read_ahead.hpp"
#include "edged/live/shed_report.hpp"
#include "edged/timing.hpp"

namespace edged {

class LiveSource {
 public:
  /// Plays `dataset` from now on, which is the thread's until stop, but for info(). The end comes at once when
  /// `interrupted` says so.
  LiveSource(Dataset& dataset, const QueueConfig& config, std::function<bool()> interrupted);

  /// As Dataset::next, but for what has been shed; waits until the next measurement is due. Throws what the dataset
  /// threw, after all that came before. Warns in the log when shedding begins and ends.
  std::optional<Measurement> next();

  /// What was measured until t has been worked up now. Returns its latency [s].
  double note_result(Timestamp t) {
    latency_.add(clock_.since_due_s(t));
    return latency_.last_s();
  }

  /// Ends the thread. Statistics stay.
  void stop() { reader_.stop(); }

  /// From when a measurement was due to its result.
  const StageTiming& latency() const { return latency_; }
  ShedCounters shed() const { return reader_.queue().shed(); }
  const StageTiming& reading() const { return reader_.reading(); }
  QueuePeaks peaks() const { return reader_.queue().peaks(); }

 private:
  LiveClock clock_;
  StageTiming latency_;
  ShedReport report_;
  ReadAhead reader_;  // last: its thread uses the clock
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording played at its own speed by a thread of its own, as sensors would: who is too slow for it misses events.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <optional>
#include <stop_token>
#include <thread>

#include "edged/core/dataset.hpp"
#include "edged/core/timing.hpp"
#include "edged/live/live_clock.hpp"
#include "edged/live/measurement_queue.hpp"
#include "edged/live/shed_report.hpp"

namespace edged {

class LiveSource {
 public:
  /// Plays `dataset` from now on, which is the thread's until stop, but for info(). The end comes at once when
  /// `interrupted` says so.
  LiveSource(Dataset& dataset, const QueueConfig& config, std::function<bool()> interrupted);
  ~LiveSource() { stop(); }

  /// As Dataset::next, but for what has been shed; waits until the next measurement is due. Throws what the dataset
  /// threw, after all that came before. Warns in the log when shedding begins and ends.
  std::optional<Measurement> next();

  /// What was measured until t has been worked up now. Returns its latency [s].
  double note_result(Timestamp t) {
    latency_.add(clock_.since_due_s(t));
    return latency_.last_s();
  }

  /// Ends the thread. Statistics stay.
  void stop();

  /// From when a measurement was due to its result.
  const StageTiming& latency() const { return latency_; }
  ShedCounters shed() const { return queue_.shed(); }
  QueuePeaks peaks() const { return queue_.peaks(); }

 private:
  void play(const std::stop_token& stop);

  Dataset& dataset_;
  std::function<bool()> interrupted_;
  MeasurementQueue queue_;
  LiveClock clock_;
  StageTiming latency_;
  ShedReport report_;
  std::exception_ptr failure_;  // set before the queue is closed
  std::jthread thread_;         // last: it uses the others
};

}  // namespace edged

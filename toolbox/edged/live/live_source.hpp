// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording played in real time, or sensors, read by a thread of its own: for a slow consumer events are thinned,
// for slow reading blocks of them skipped.
#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include "edged/dataset.hpp"
#include "edged/live/drop_report.hpp"
#include "edged/live/event_thinner.hpp"
#include "edged/live/live_clock.hpp"
#include "edged/live/read_ahead.hpp"
#include "edged/timing.hpp"

namespace edged {

class LiveSource {
 public:
  /// Plays `dataset` from now on, or receives what arrives; only the thread may use it until stop, except info(). Ends
  /// at once when `interrupted` returns true. on_due: called by the thread with each measurement when it is due, before
  /// it is queued.
  LiveSource(Dataset& dataset, const QueueConfig& config, std::function<bool()> interrupted,
             std::function<void(const Measurement&)> on_due = {}, Due due = Due::BySpeed);

  /// As Dataset::next, without dropped measurements; waits until the next one is due. Rethrows errors of the dataset
  /// after all measurements before them. Warns in the log when dropping begins and ends.
  std::optional<Measurement> next();

  /// Measurements up to t have been processed now. Returns their latency [s].
  double note_result(Timestamp t) {
    latency_.add(clock_.since_due_s(t));
    return latency_.last_s();
  }

  /// Ends the thread. Statistics stay.
  void stop() { reader_.stop(); }

  /// From the due time of a measurement to its result.
  const StageTiming& latency() const { return latency_; }
  /// By the queue, by thinning before it, and by the reader.
  DropCounters dropped() const;
  const StageTiming& reading() const { return reader_.reading(); }
  QueuePeaks peaks() const { return reader_.queue().peaks(); }

 private:
  LiveClock::Clock::time_point pace(Measurement& measurement, const std::function<bool()>& stopped);
  void lighten(EventBatch& batch, LiveClock::Clock::time_point due);

  Dataset& dataset_;
  const double free_delay_s_;
  std::function<void(const Measurement&)> on_due_;
  LiveClock clock_;
  StageTiming latency_;
  DropReport report_;
  OverloadThinner thinner_;
  OverloadShare read_share_;
  std::optional<Timestamp> newest_events_;
  std::atomic<std::size_t> unread_ = 0;
  ReadAhead reader_;  // last member: its thread uses the others
};

}  // namespace edged

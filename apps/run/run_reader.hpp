// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How a run gets its measurements: from a thread that reads ahead, from one that plays the recording in real time, or,
// for a simulation, in the thread of the run.
#pragma once

#include <functional>
#include <optional>

#include "edged/live/live_source.hpp"
#include "edged/live/read_ahead.hpp"
#include "run/run_context.hpp"

namespace edged {

class RunReader {
 public:
  /// Starts to read. on_due: called by LiveSource, in a live run.
  RunReader(RunContext& run, std::function<void(const Measurement&)> on_due);

  /// Nothing at the end, or after an interrupt.
  std::optional<Measurement> next();
  /// The result for t is complete. Returns its latency [s], in a live run.
  std::optional<double> note_result(Timestamp t);
  /// The dataset is no longer read.
  void stop();
  /// By a live run, so far.
  DropCounters dropped() const { return live_ ? live_->dropped() : DropCounters{}; }
  std::optional<LiveSummary> live_summary(const OdometryCounters& counters) const;

 private:
  std::optional<Measurement> read();

  RunContext& run_;
  std::optional<LiveSource> live_;
  std::optional<ReadAhead> ahead_;
};

}  // namespace edged

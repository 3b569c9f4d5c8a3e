// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_reader.hpp"

#include <utility>

#include "common/interrupt.hpp"

namespace edged {
namespace {

/// Events and frames read ahead: a packet of a wide sensor in fast motion, and little relative to the memory of a run.
constexpr int kReadAheadMegabytes = 16;

}  // namespace

RunReader::RunReader(RunContext& run, std::function<void(const Measurement&)> on_due) : run_(run) {
  const auto interrupted = [] { return interrupt_signal() != 0; };
  Dataset& dataset = *run_.source.dataset;
  // The cost of simulation is not part of the cost of estimation, so it does not run in parallel.
  if (run_.source.seed) return;
  if (run_.options.live) {
    const Due due = is_live(run_.options.source) ? Due::OnArrival : Due::BySpeed;
    live_.emplace(dataset, run_.config.live, interrupted, std::move(on_due), due);
  } else {
    ahead_.emplace(dataset, QueueConfig{.max_megabytes = kReadAheadMegabytes}, WhenFull::Wait, interrupted);
  }
}

std::optional<Measurement> RunReader::next() { return interrupt_signal() == 0 ? read() : std::nullopt; }

std::optional<Measurement> RunReader::read() {
  const auto timer = run_.timings.measure_often(run_.source.seed ? "simulate" : "wait");
  if (live_) return live_->next();
  if (ahead_) return ahead_->next();
  return run_.meter.without([this] { return run_.source.dataset->next(); });
}

std::optional<double> RunReader::note_result(Timestamp t) {
  return live_ ? std::optional(live_->note_result(t)) : std::nullopt;
}

void RunReader::stop() {
  if (live_) live_->stop();
  if (ahead_) ahead_->stop();
  if (live_ || ahead_) run_.timings.put("read", live_ ? live_->reading() : ahead_->reading());
}

std::optional<LiveSummary> RunReader::live_summary(const OdometryCounters& counters) const {
  if (!live_) return std::nullopt;
  return LiveSummary{live_->latency(), live_->dropped(), counters.packets.packets_overflow, live_->peaks(),
                     run_.config.live.max_age_s};
}

}  // namespace edged

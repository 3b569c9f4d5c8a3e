// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/live_source.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {

LiveSource::LiveSource(Dataset& dataset, const QueueConfig& config, std::function<bool()> interrupted,
                       std::function<void(const Measurement&)> on_due, Due due)
    : on_due_(std::move(on_due)),
      clock_(due),
      thinner_(config.max_age_s),
      reader_(dataset, config, WhenFull::Drop, std::move(interrupted),
              [this](Measurement& measurement, const auto& stopped) { return pace(measurement, stopped); }) {}

LiveClock::Clock::time_point LiveSource::pace(Measurement& measurement, const std::function<bool()>& stopped) {
  LiveClock::Clock::time_point due = LiveClock::Clock::now();
  if (const auto t = last_stamp(measurement)) due = clock_.wait_for(*t, stopped);
  if (on_due_ && !stopped()) on_due_(measurement);
  if (auto* batch = std::get_if<EventBatch>(&measurement)) {
    const auto oldest = std::min(due, reader_.queue().waits_since().value_or(due));
    thinner_.thin(*batch, to_seconds(LiveClock::Clock::now() - oldest));
  }
  return due;
}

DropCounters LiveSource::dropped() const {
  DropCounters dropped = reader_.queue().dropped();
  dropped.events += thinner_.dropped();
  return dropped;
}

std::optional<Measurement> LiveSource::next() {
  std::optional<Measurement> measurement = reader_.next();
  if (const auto line = report_.update(dropped(), DropReport::Clock::now())) spdlog::warn(*line);
  return measurement;
}

}  // namespace edged

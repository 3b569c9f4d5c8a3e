// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/live_source.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

constexpr double kLeastRead = 0.01;  // bounds the delay of readers that are up to some 20 times too slow

}  // namespace

LiveSource::LiveSource(Dataset& dataset, const QueueConfig& config, std::function<bool()> interrupted,
                       std::function<void(const Measurement&)> on_due, Due due)
    : dataset_(dataset),
      free_delay_s_(free_delay_s(config.max_age_s)),
      on_due_(std::move(on_due)),
      clock_(due),
      thinner_(config.max_age_s),
      reader_(dataset, config, WhenFull::Drop, std::move(interrupted),
              [this](Measurement& measurement, const auto& stopped) { return pace(measurement, stopped); }) {}

LiveClock::Clock::time_point LiveSource::pace(Measurement& measurement, const std::function<bool()>& stopped) {
  LiveClock::Clock::time_point due = LiveClock::Clock::now();
  if (const auto t = last_stamp(measurement)) due = clock_.wait_for(*t, stopped);
  if (on_due_ && !stopped()) on_due_(measurement);
  if (auto* batch = std::get_if<EventBatch>(&measurement); batch && !batch->events.empty()) lighten(*batch, due);
  return due;
}

/// The consumer is behind by the age of what waits relative to this batch, reading by its time since it was due: each
/// gets fewer events until its own delay is a free one, so that their sum is bounded, too.
void LiveSource::lighten(EventBatch& batch, LiveClock::Clock::time_point due) {
  const Timestamp newest = batch.events.back().t;
  const double passed_s = to_seconds(newest - std::exchange(newest_events_, newest).value_or(newest));
  const double late_s = to_seconds(LiveClock::Clock::now() - due);
  const double read = read_share_.next(late_s / free_delay_s_, std::max(0.0, passed_s), kLeastRead);
  unread_ = dataset_.skip_events(1.0 - read);
  const auto oldest = std::min(due, reader_.queue().waits_since().value_or(due));
  thinner_.thin(batch, to_seconds(due - oldest), unread_ > 0 ? read : 1.0);  // text cannot be skipped
}

DropCounters LiveSource::dropped() const {
  DropCounters dropped = reader_.queue().dropped();
  dropped.unread = unread_;
  dropped.events += thinner_.dropped() + dropped.unread;
  return dropped;
}

std::optional<Measurement> LiveSource::next() {
  std::optional<Measurement> measurement = reader_.next();
  if (const auto line = report_.update(dropped(), DropReport::Clock::now())) spdlog::warn(*line);
  return measurement;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/live_source.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {
namespace {

constexpr double kFree = 0.08;  // of the allowed age: longer than most packets take

}  // namespace

LiveSource::LiveSource(Dataset& dataset, const QueueConfig& config, std::function<bool()> interrupted,
                       std::function<void(const Measurement&)> on_due)
    : free_age_s_(kFree * config.max_age_s),
      on_due_(std::move(on_due)),
      reader_(dataset, config, WhenFull::Shed, std::move(interrupted),
              [this](Measurement& measurement, const auto& stopped) { pace(measurement, stopped); }) {}

void LiveSource::pace(Measurement& measurement, const std::function<bool()>& stopped) {
  if (const auto t = last_stamp(measurement)) clock_.wait_for(*t, stopped);
  if (on_due_ && !stopped()) on_due_(measurement);
  if (auto* batch = std::get_if<EventBatch>(&measurement)) thin(*batch);
}

void LiveSource::thin(EventBatch& batch) {
  if (batch.events.empty()) return;
  const Timestamp last = batch.events.back().t, waits_since = reader_.queue().waits_since().value_or(last);
  const double delay_s = to_seconds(clock_.now() - std::min(waits_since, last));
  const double share = share_.next(delay_s / free_age_s_, to_seconds(last - batch.events.front().t));
  thinned_ += thinners_[batch.camera].thin(batch.events, share);
}

ShedCounters LiveSource::shed() const {
  ShedCounters shed = reader_.queue().shed();
  shed.events += thinned_;
  return shed;
}

std::optional<Measurement> LiveSource::next() {
  std::optional<Measurement> measurement = reader_.next();
  if (const auto line = report_.update(shed(), ShedReport::Clock::now())) spdlog::warn(*line);
  return measurement;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/backlog.hpp"

#include <algorithm>

#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged::node {
namespace {

constexpr Duration kClockSetBack = std::chrono::seconds(2);  // more than sensors lag behind each other

}  // namespace

Backlog::Backlog(double max_age_s) : max_age_(duration_from_seconds(max_age_s)) {}

bool Backlog::admit(const Measurement& measurement) {
  const std::optional<Timestamp> stamp = last_stamp(measurement);
  if (!stamp) return true;
  const std::lock_guard lock(mutex_);
  const bool set_back = newest_ && *newest_ - *stamp > kClockSetBack;
  newest_ = set_back ? *stamp : std::max(newest_.value_or(*stamp), *stamp);
  const Duration age = working_ && step_ ? *stamp - *step_ : Duration(0);
  if (const auto* batch = std::get_if<EventBatch>(&measurement); batch && age > max_age_) {
    counters_.events += batch->events.size();
    return false;
  }
  if (std::holds_alternative<Frame>(measurement) && age > 2 * max_age_) {
    ++counters_.frames;
    return false;
  }
  return true;
}

void Backlog::note_step(Timestamp t) {
  const std::lock_guard lock(mutex_);
  working_ = true;
  step_ = t;
}

void Backlog::note_idle() {
  const std::lock_guard lock(mutex_);
  working_ = false;
}

BacklogCounters Backlog::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

std::optional<Duration> Backlog::age() const {
  const std::lock_guard lock(mutex_);
  if (!newest_ || !step_) return std::nullopt;
  return *newest_ - *step_;
}

}  // namespace edged::node

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Merges two streams in time order. Internal to io.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// Takes the part of the held measurement before t: all of it, the first events of a batch, or nothing.
inline std::optional<Measurement> take_before(std::optional<Measurement>& held, Timestamp t) {
  if (!held || *first_stamp(*held) >= t) return std::nullopt;
  auto* batch = std::get_if<EventBatch>(&*held);
  if (batch == nullptr || batch->events.back().t < t) return std::exchange(held, std::nullopt);
  const auto cut = std::ranges::lower_bound(batch->events, t, {}, &Event::t);
  EventBatch front{batch->camera, {batch->events.begin(), cut}};
  batch->events.erase(batch->events.begin(), cut);
  return front;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// When a measurement was made, and by which camera.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "edged/measurement.hpp"

namespace edged {

/// Within 146 years of zero: differences of such stamps fit into a Duration.
constexpr bool is_plausible(Timestamp t) {
  constexpr Duration kLongest(std::int64_t{1} << 62U);
  return t.time_since_epoch() < kLongest && t.time_since_epoch() > -kLongest;
}

/// The stamp of the measurement, of a batch its newest event's; nothing for an empty batch.
inline std::optional<Timestamp> last_stamp(const Measurement& measurement) {
  if (const auto* frame = std::get_if<Frame>(&measurement)) return frame->t;
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) return sample->t;
  const std::vector<Event>& events = std::get<EventBatch>(measurement).events;
  return events.empty() ? std::nullopt : std::optional(events.back().t);
}

/// The stamp of the measurement, of a batch its oldest event's; nothing for an empty batch.
inline std::optional<Timestamp> first_stamp(const Measurement& measurement) {
  const auto* batch = std::get_if<EventBatch>(&measurement);
  return batch && !batch->events.empty() ? std::optional(batch->events.front().t) : last_stamp(measurement);
}

/// The name of the camera that gave it; null for an IMU sample.
inline const std::string* camera_of(const Measurement& measurement) {
  if (const auto* batch = std::get_if<EventBatch>(&measurement)) return &batch->camera;
  const auto* frame = std::get_if<Frame>(&measurement);
  return frame ? &frame->camera : nullptr;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The stamp of a measurement, and the name of its sensor.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>

#include "edged/measurement.hpp"

namespace edged {

/// Within 146 years of zero: differences of such stamps fit into a Duration.
constexpr bool is_plausible(Timestamp t) {
  constexpr Duration kLongest(std::int64_t{1} << 62U);
  return t.time_since_epoch() < kLongest && t.time_since_epoch() > -kLongest;
}

/// The stamp of an item that has one.
template <typename T>
Timestamp time_of(const T& item) {
  return item.t;
}
inline Timestamp time_of(const ExternalSample& sample) {
  return std::visit([](const auto& one) { return one.t; }, sample);
}

/// The stamp of the measurement, of a batch its newest event's; nothing for an empty batch.
inline std::optional<Timestamp> last_stamp(const Measurement& measurement) {
  return std::visit(
      []<typename T>(const T& item) -> std::optional<Timestamp> {
        if constexpr (std::is_same_v<T, EventBatch>) {
          return item.events.empty() ? std::nullopt : std::optional(item.events.back().t);
        } else {
          return time_of(item);
        }
      },
      measurement);
}

/// The stamp of the measurement, of a batch its oldest event's; nothing for an empty batch.
inline std::optional<Timestamp> first_stamp(const Measurement& measurement) {
  const auto* batch = std::get_if<EventBatch>(&measurement);
  return batch && !batch->events.empty() ? std::optional(batch->events.front().t) : last_stamp(measurement);
}

/// The name of its camera; null for a sample of another sensor.
inline const std::string* camera_of(const Measurement& measurement) {
  if (const auto* batch = std::get_if<EventBatch>(&measurement)) return &batch->camera;
  const auto* frame = std::get_if<Frame>(&measurement);
  return frame ? &frame->camera : nullptr;
}

}  // namespace edged

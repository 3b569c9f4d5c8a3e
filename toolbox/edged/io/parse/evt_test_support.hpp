// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Events to encode, for tests, fuzzing and benchmarks.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/parse/evt.hpp"

namespace edged {

/// Events in time order with rows of neighbours, so that the vector words of EVT 2.1 and 3 are used.
/// Stamps are whole microseconds.
inline std::vector<Event> generated_events(std::size_t count, int width, int height, std::int64_t mean_step_us) {
  std::mt19937_64 random(7);
  const auto below = [&random](std::int64_t n) {
    return static_cast<std::int64_t>(random() % static_cast<unsigned>(n));
  };
  std::vector<Event> events;
  std::int64_t t_us = 1000;
  while (events.size() < count) {
    t_us += below(2 * mean_step_us + 1);
    const std::int64_t y = below(height), x = below(width), run = 1 + below(40);
    const bool positive = below(2) == 1;
    for (std::int64_t i = 0; i < run && x + i < width && events.size() < count; i += 1 + below(3))
      events.push_back(
          {timestamp_from_ns(t_us * 1000), static_cast<std::uint16_t>(x + i), static_cast<std::uint16_t>(y), positive});
  }
  return events;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/shed_report.hpp"

#include <spdlog/fmt/fmt.h>

namespace edged {
namespace {
constexpr auto kQuiet = std::chrono::seconds(1);
constexpr auto kBetweenBouts = std::chrono::seconds(10);
}  // namespace

std::optional<std::string> ShedReport::update(const ShedCounters& total, Clock::time_point now) {
  if (total != seen_) {
    seen_ = total;
    last_shed_ = now;
    if (telling_ || (said_ && now - *said_ < kBetweenBouts)) return std::nullopt;
    telling_ = true;
    said_ = now;
    return "too slow for these sensors: events are thinned, the oldest events are dropped";
  }
  if (!telling_ || now - last_shed_ < kQuiet) return std::nullopt;
  telling_ = false;
  std::string line = fmt::format("in real time again: {} events and {} frames were dropped",
                                 total.events - told_.events, total.frames - told_.frames);
  told_ = total;
  return line;
}

}  // namespace edged

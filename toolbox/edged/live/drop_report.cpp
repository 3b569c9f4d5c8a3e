// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/live/drop_report.hpp"

#include <spdlog/fmt/fmt.h>

namespace edged {
namespace {
constexpr auto kQuiet = std::chrono::seconds(1);
constexpr auto kBetweenReports = std::chrono::seconds(10);
}  // namespace

std::optional<std::string> DropReport::update(const DropCounters& total, Clock::time_point now) {
  if (total != total_) {
    total_ = total;
    last_drop_ = now;
    if (dropping_ || (begin_ && now - *begin_ < kBetweenReports)) return std::nullopt;
    dropping_ = true;
    begin_ = now;
    return "too slow for these sensors: events are thinned, the oldest events are dropped";
  }
  if (!dropping_ || now - last_drop_ < kQuiet) return std::nullopt;
  dropping_ = false;
  std::string line = fmt::format("in real time again: {} events and {} frames were dropped",
                                 total.events - reported_.events, total.frames - reported_.frames);
  reported_ = total;
  return line;
}

}  // namespace edged

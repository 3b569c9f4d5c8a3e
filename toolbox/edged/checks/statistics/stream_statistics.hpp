// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Regularity of the stamps of one sensor.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "edged/time.hpp"

namespace edged {

struct Gap {
  Timestamp after;  ///< stamp before the gap
  Duration length{0};
};

struct StreamStatistics {
  std::size_t count = 0;
  std::optional<Timestamp> begin, end;
  Duration typical_step{0};  ///< median of the first steps
  std::size_t gaps = 0;      ///< steps that are too long
  Duration missing{0};       ///< their sum
  std::vector<Gap> longest;  ///< the longest of them, longest first

  Duration length() const { return begin && end ? *end - *begin : Duration(0); }
  double rate_hz() const {
    return length() > Duration(0) ? static_cast<double>(count - 1) / to_seconds(length()) : 0.0;
  }
};

/// Stamps of one sensor, in order. Memory is bounded.
class StreamCollector {
 public:
  /// longest_step: longer ones are gaps; by default 2.5 typical steps.
  explicit StreamCollector(std::optional<Duration> longest_step = std::nullopt) : longest_step_(longest_step) {}

  /// `count` measurements from `first` to `last`.
  void add(Timestamp first, Timestamp last, std::size_t count = 1);
  StreamStatistics result() const;

 private:
  void learn();
  void judge(const Gap& step);

  std::optional<Duration> longest_step_;
  std::vector<Gap> steps_;  ///< the first ones, until the typical step is known
  StreamStatistics statistics_;
};

}  // namespace edged

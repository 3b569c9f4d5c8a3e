// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Thins a stream of states out to a rate.
#pragma once

#include <optional>

#include "edged/time.hpp"

namespace edged {

/// On average at the rate, whatever that of the stream; also after a pause, and after a clock that jumped back.
class RateLimit {
 public:
  explicit RateLimit(double rate_hz) : period_(duration_from_seconds(1.0 / rate_hz)) {}

  /// Whether the state at t is to be sent.
  bool is_due(Timestamp t) {
    if (next_ && t < *next_ && *next_ - t <= period_) return false;
    const bool steady = next_ && t >= *next_ && t - *next_ < period_;
    next_ = (steady ? *next_ : t) + period_;
    return true;
  }

 private:
  Duration period_;
  std::optional<Timestamp> next_;
};

}  // namespace edged

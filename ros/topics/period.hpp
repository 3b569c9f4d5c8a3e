// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// At most one message a period, by the stamps of the sensors.
#pragma once

#include <optional>

#include "edged/time.hpp"

namespace edged::node {

/// After a clock that jumped back the next message is due at once.
class Period {
 public:
  explicit Period(Duration length) : length_(length) {}

  bool is_over(Timestamp t) const { return !begin_ || t < *begin_ || t - *begin_ >= length_; }
  /// Begins the next one if this one is over, and returns whether it was.
  bool begins(Timestamp t) {
    if (!is_over(t)) return false;
    begin_ = t;
    return true;
  }

 private:
  Duration length_;
  std::optional<Timestamp> begin_;
};

}  // namespace edged::node

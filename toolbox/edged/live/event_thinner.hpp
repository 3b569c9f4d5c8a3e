// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Leaves out events evenly over image and polarity, where there are more than can be processed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "edged/measurement.hpp"

namespace edged {

/// Of the events of one polarity in a block of 8 x 8 px, every so many-th stays: about what a sensor with higher
/// thresholds would have sent. Of one camera. Deterministic. Memory: 64 kB.
class EventThinner {
 public:
  EventThinner();

  /// Keeps about that share of the events, from 0 to 1, in their order. Returns how many were left out.
  std::size_t thin(std::vector<Event>& events, double share);

 private:
  std::vector<std::uint16_t> sums_;  // by block and polarity: 2^16 of them, or more, are an event that stays
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Maps the stamps of measurements that arrive live to the clock of this machine.
#pragma once

#include <algorithm>

#include "edged/time.hpp"

namespace edged {

/// Stamps may count from any epoch, and their clock may drift. The measurement with the least delay of the last 10 to
/// 20 s is taken to have arrived without any: delays of the program and of a busy line do not shift the others.
class ArrivalClock {
 public:
  /// Stamps in time order; one that goes back begins anew. now: by the clock of this machine.
  void arrived(Timestamp t, Duration now);
  /// By the clock of this machine; after the first arrival.
  Duration at(Timestamp t) const { return t.time_since_epoch() + std::min(least_, least_before_); }

 private:
  Timestamp newest_ = Timestamp::min(), begin_ = Timestamp::min();  ///< of all stamps; of the span of least_
  Duration least_ = Duration::max(), least_before_ = Duration::max();
};

}  // namespace edged

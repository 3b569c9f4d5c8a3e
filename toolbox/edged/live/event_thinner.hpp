// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Drops events evenly over image and polarity, where there are more than can be processed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "edged/measurement.hpp"

namespace edged {

/// Keeps every so many-th event of one polarity in a block of 8 x 8 px: about what a sensor with higher thresholds
/// would have sent. For the events of one camera. Deterministic. Memory: 64 kB.
class EventThinner {
 public:
  EventThinner();

  /// Keeps about that share of the events, from 0 to 1, in their order. Returns how many were dropped.
  std::size_t thin(std::vector<Event>& events, double share);

 private:
  std::vector<std::uint16_t> sums_;  // by block and polarity: 2^16 of them, or more, are an event that is kept
};

/// The share of new events that is kept, by the delay. It follows the delay at once; were that all, the delay would
/// stay as long as the overload does. So a delay that lasts changes a lasting share, too, until the delay is free
/// again.
class OverloadShare {
 public:
  /// delay: 1 is the longest that is free. passed_s: since the last call. At most 1; a small share is always kept.
  double next(double delay, double passed_s);

 private:
  double lasting_ = 1.0;
};

/// While a measurement waits longer than a small part of the allowed age, a share of the new events is kept that falls
/// until the wait is that part again: the events become fewer in the whole image, and there is no gap in time. A small
/// share is always kept: where reading itself is too slow, it would not help to drop all. From any thread.
class OverloadThinner {
 public:
  /// max_age_s: that of QueueConfig.
  explicit OverloadThinner(double max_age_s);

  /// Drops events of a new batch. delay_s: how long the oldest measurement has waited.
  void thin(EventBatch& batch, double delay_s);
  /// Number of events dropped so far.
  std::size_t dropped() const;

 private:
  const double free_age_s_;  ///< the longest wait without thinning
  mutable std::mutex mutex_;
  OverloadShare share_;
  std::map<std::string, EventThinner> thinners_;  ///< by camera
  std::size_t dropped_ = 0;
};

}  // namespace edged

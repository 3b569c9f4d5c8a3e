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
  /// delay: 1 is the longest that is free. passed_s: since the last call. least: the share that is always kept. At
  /// most 1.
  double next(double delay, double passed_s, double least = kLeastKept);

  static constexpr double kLeastKept = 0.08;

 private:
  double lasting_ = 1.0;
};

/// The longest delay [s] without thinning: longer than most packets take. max_age_s: that of QueueConfig.
inline double free_delay_s(double max_age_s) { return 0.08 * max_age_s; }

/// While a measurement waits longer than a small part of the allowed age, a share of the new events is kept that falls
/// until the wait is that part again: the events become fewer in the whole image, and there is no gap in time. A small
/// share is always kept. From any thread.
class OverloadThinner {
 public:
  /// max_age_s: that of QueueConfig.
  explicit OverloadThinner(double max_age_s);

  /// Drops events of a new batch. delay_s: how much older the oldest measurement is that waits.
  /// read: the share of all events that is read; what is skipped counts among those not kept.
  void thin(EventBatch& batch, double delay_s, double read = 1.0);
  /// Number of events dropped so far.
  std::size_t dropped() const;

 private:
  const double free_delay_s_;
  mutable std::mutex mutex_;
  OverloadShare share_;
  std::map<std::string, EventThinner> thinners_;  ///< by camera
  std::size_t dropped_ = 0;
};

}  // namespace edged

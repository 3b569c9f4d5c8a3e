// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The state of the body between the newest estimate and the newest IMU sample: what a controller needs.
#pragma once

#include <mutex>
#include <optional>
#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/measurement.hpp"
#include "edged/state.hpp"

namespace edged {

/// From any thread, and cheap: a sample costs one step of integration, an estimate as many as samples have come since.
class StatePrediction {
 public:
  /// Samples in time order; one that is not, or holds what is no number, is passed over; after a jump of more than 20 s
  /// ahead or 1 s back it begins anew. Without an estimate for long, those of the last 20 to 40 s are kept.
  void add(const ImuSample& sample);

  /// The newest estimate; nothing when there is none to go by.
  void correct(const std::optional<NavState>& estimate);

  /// At the newest sample; the estimate itself where none has come since. Nothing without an estimate.
  std::optional<NavState> newest() const;
  /// At a time between the estimate and the newest sample, else nothing.
  std::optional<NavState> at(Timestamp t) const;

 private:
  mutable std::mutex mutex_;
  std::vector<ImuSample> imu_;     // with an estimate: the first at its time
  std::vector<OdomState> states_;  // at the samples; empty without an estimate
};

}  // namespace edged

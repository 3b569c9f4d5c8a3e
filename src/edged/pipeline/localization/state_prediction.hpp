// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The state of the body between the newest estimate and the newest IMU sample: for a controller.
#pragma once

#include <mutex>
#include <optional>
#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/imu/imu_gate.hpp"
#include "edged/measurement.hpp"
#include "edged/state.hpp"

namespace edged {

/// From any thread, and cheap: a sample costs one step of integration, an estimate one per sample since.
class StatePrediction {
 public:
  /// Samples in time order; those that the gate refuses are ignored; after a jump of more than 20 s ahead or 1 s
  /// back it starts again. Without an estimate the samples of the last 20 to 40 s are kept.
  void add(const ImuSample& sample);

  /// The newest estimate; nothing without one.
  void correct(const std::optional<NavState>& estimate);

  /// At the newest sample; the estimate itself without later samples. Nothing without an estimate.
  std::optional<NavState> newest() const;
  /// At a time between the estimate and the newest sample, else nothing.
  std::optional<NavState> at(Timestamp t) const;

 private:
  void follow(const ImuSample& sample);

  mutable std::mutex mutex_;
  ImuGate gate_;
  std::vector<ImuSample> imu_;     // with an estimate: the first at its time
  std::vector<OdomState> states_;  // at the samples; empty without an estimate
};

}  // namespace edged

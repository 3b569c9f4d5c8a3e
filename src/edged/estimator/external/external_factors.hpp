// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Turns samples of external sensors into factors of the window: gating and placement.
#pragma once

#include <optional>
#include <span>

#include "edged/counters.hpp"
#include "edged/estimator/window/window.hpp"
#include "edged/measurement.hpp"
#include "edged/options/estimator.hpp"

namespace edged {

class ExternalFactors {
 public:
  ExternalFactors(const HeightConfig& height, const VelocityConfig& velocity) : height_(height), velocity_(velocity) {}

  /// Puts samples of the IMU interval from a state on into the window, in time order. imu: that interval; samples
  /// outside it, and those that fail the gate, are dropped.
  void add(Window& window, StateId from, const Preintegration& imu, std::span<const ExternalSample> samples);
  /// As add(), to a window that has not been solved yet: only what is grossly wrong is left out.
  void add_to_start(Window& window, StateId from, const Preintegration& imu, std::span<const ExternalSample> samples);

  /// Whether a velocity sample from just before t is in the window.
  bool velocity_observed(Timestamp t) const;

  /// What became of the samples so far.
  const ExternalCounters& counters() const { return counters_; }

 private:
  bool passes_gate(const Window& window, const Factor& factor) const;
  void add_sample(Window& window, StateId from, const Preintegration& imu, const HeightSample& sample);
  void add_sample(Window& window, StateId from, const Preintegration& imu, const VelocitySample& sample);

  HeightConfig height_;
  VelocityConfig velocity_;
  bool starting_ = false;
  ExternalCounters counters_;
  std::optional<Timestamp> height_refused_since_, velocity_at_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/localization/state_prediction.hpp"

#include <algorithm>
#include <span>

#include "edged/core/measurements/measurement_stamps.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/pipeline/tuning.hpp"

namespace edged {
namespace {

/// The state at the last sample, propagated from `start` at the first one.
OdomState propagated(const OdomState& start, std::span<const ImuSample> samples) {
  return propagate_all(start, samples).back();
}

/// The IMU only needs a frame with z up, so M can replace O while the map does not change T_M_O.
OdomState as_odometry(const NavState& s) { return {s.t, s.T_W_B, s.v_W, s.bias_gyro, s.bias_accel}; }
NavState in_map(const OdomState& s) { return {s.t, s.T_O_B, s.v_O, s.bias_gyro, s.bias_accel}; }

}  // namespace

void StatePrediction::add(const ImuSample& sample) {
  const std::lock_guard lock(mutex_);
  if (!is_plausible(sample.t)) return;
  const Duration ahead = imu_.empty() ? Duration(0) : sample.t - imu_.back().t;
  if (ahead > kPipelineTuning.imu_history ||
      ahead < -kPipelineTuning.clock_jump) {  // another clock, or a damaged stamp
    imu_.clear();
    states_.clear();
    gate_ = ImuGate();
  }
  for (const ImuSample& passed : gate_.push(sample)) follow(passed);
}

void StatePrediction::follow(const ImuSample& sample) {
  imu_.push_back(sample);
  if (!states_.empty()) states_.push_back(propagated(states_.back(), std::span(imu_).last(2)));
  if (!states_.empty() && to_seconds(sample.t - states_.front().t) > kPipelineTuning.longest_gap_s) states_.clear();
  if (sample.t - imu_.front().t <= 2 * kPipelineTuning.imu_history) return;
  const auto keep = std::ranges::lower_bound(imu_, sample.t - kPipelineTuning.imu_history, {}, &ImuSample::t);
  imu_.erase(imu_.begin(), keep);
}

void StatePrediction::correct(const std::optional<NavState>& estimate) {
  const std::lock_guard lock(mutex_);
  states_.clear();
  if (!estimate || imu_.empty() || estimate->t < imu_.front().t || estimate->t > imu_.back().t) return;
  if (to_seconds(imu_.back().t - estimate->t) > kPipelineTuning.longest_gap_s) return;
  imu_ = slice_imu(imu_, estimate->t, imu_.back().t);
  states_ = propagate_all(as_odometry(*estimate), imu_);
}

std::optional<NavState> StatePrediction::newest() const {
  const std::lock_guard lock(mutex_);
  return states_.empty() ? std::nullopt : std::optional(in_map(states_.back()));
}

std::optional<NavState> StatePrediction::at(Timestamp t) const {
  const std::lock_guard lock(mutex_);
  if (states_.empty() || t < states_.front().t || t > states_.back().t) return std::nullopt;
  const auto before = std::prev(std::ranges::upper_bound(states_, t, {}, &OdomState::t));
  const auto first = static_cast<std::size_t>(before - states_.begin());
  return in_map(propagated(*before, slice_imu(std::span(imu_).subspan(first), before->t, t)));
}

}  // namespace edged

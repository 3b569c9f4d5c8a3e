// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "covariance_samples.hpp"

namespace edged {

void CovarianceSamples::add(const Step& step) {
  const bool good = step.status == TrackingStatus::Good;
  // Packets after the first of a loss only skip a number.
  if (step.status == TrackingStatus::Lost || step.relocalized) ++start_;
  if (!step.covariance || !is_tracking(step.status)) return;
  const auto& [position, rotation] = *step.covariance;
  const auto old = [&](const PoseCovarianceSample& last) {
    return last.start == start_ && last.good && last.position == position;
  };
  if (good && !samples_.empty() && old(samples_.back())) return;
  samples_.push_back({step.t, step.state.T_W_B, position, rotation, good, start_});
}

}  // namespace edged

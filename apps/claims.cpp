// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "claims.hpp"

namespace edged {

void Claims::add(Timestamp packet, const OdometryOutput& output) {
  const bool good = output.status == TrackingStatus::Good;
  // Packets after the first of a loss only skip a number.
  if (output.status == TrackingStatus::Lost) ++start_;
  if (!output.covariance || !is_tracking(output.status)) return;
  const auto& [position, rotation] = *output.covariance;
  const auto old = [&](const ClaimedPose& last) {
    return last.start == start_ && last.good && last.position == position;
  };
  if (good && !claims_.empty() && old(claims_.back())) return;
  claims_.push_back({packet, output.state.T_W_B, position, rotation, good, start_});
}

}  // namespace edged

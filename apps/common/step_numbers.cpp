// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/step_numbers.hpp"

#include <algorithm>

namespace edged {

ModalityNumbers modality_numbers(const Step& step, Modality modality) {
  ModalityNumbers numbers;
  double survival_rate = 0.0;
  int cameras = 0;
  for (const CameraStep& camera : step.cameras) {
    if (camera.modality != modality) continue;
    numbers.tracks += camera.tracks.size();
    numbers.event_rate_hz += camera.event_rate_hz;
    survival_rate += camera.survival_rate;
    ++cameras;
  }
  if (cameras > 0) numbers.survival_rate = survival_rate / cameras;
  return numbers;
}

std::optional<double> map_reach_s(const Step& step) {
  const auto oldest = std::ranges::min_element(step.map_matches, {}, &MapMatch::keyframe);
  return oldest == step.map_matches.end() ? std::nullopt : std::optional(to_seconds(step.t - oldest->keyframe));
}

std::string reason_of(const Step& step) {
  switch (step.status) {
    case TrackingStatus::Initializing:
      return step.waiting_for.empty() ? "" : "waits for " + step.waiting_for;
    case TrackingStatus::Lost:
      return step.lost_because;
    default:
      if (step.relocalized) return "relocalized in the map";
      return step.started.empty() ? step.degraded_because : "started " + step.started;
  }
}

void StatusChanges::add(const Step& step) {
  if (changes_.empty() || changes_.back().status != step.status || step.relocalized) {
    changes_.push_back({step.t, step.status, reason_of(step), step.relocalized});
  } else if (const std::string reason = reason_of(step); !reason.empty() && !is_tracking(step.status)) {
    changes_.back().reason = reason;  // the last reason is the most useful one
  }
}

}  // namespace edged

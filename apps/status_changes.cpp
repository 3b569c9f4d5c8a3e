// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "status_changes.hpp"

namespace edged {

std::string reason_of(const Step& step) {
  switch (step.status) {
    case TrackingStatus::Initializing:
      return step.waiting_for.empty() ? "" : "waits for " + step.waiting_for;
    case TrackingStatus::Lost:
      return step.lost_because;
    default:
      if (step.relocalized) return "found again in the map";
      return step.started.empty() ? "" : "started " + step.started;
  }
}

void StatusChanges::add(const Step& step) {
  if (changes_.empty() || changes_.back().status != step.status || step.relocalized) {
    changes_.push_back({step.t, step.status, reason_of(step), step.relocalized});
  } else if (const std::string reason = reason_of(step); !reason.empty() && !is_tracking(step.status)) {
    changes_.back().reason = reason;  // what was missing last says most
  }
}

}  // namespace edged

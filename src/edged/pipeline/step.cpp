// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/step.hpp"

#include <algorithm>

#include "edged/core/check.hpp"

namespace edged {

std::string to_string(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::Initializing:
      return "Initializing";
    case TrackingStatus::Good:
      return "Good";
    case TrackingStatus::Degraded:
      return "Degraded";
    case TrackingStatus::Lost:
      return "Lost";
  }
  EDGED_CHECK(false, "status {}", static_cast<int>(status));
}

bool is_tracking(TrackingStatus status) { return status == TrackingStatus::Good || status == TrackingStatus::Degraded; }

const CameraStep* Step::find(Modality modality) const {
  const auto it = std::ranges::find(cameras, modality, &CameraStep::modality);
  return it == cameras.end() ? nullptr : &*it;
}

const CameraStep* Step::find(std::string_view camera) const {
  const auto it = std::ranges::find(cameras, camera, &CameraStep::name);
  return it == cameras.end() ? nullptr : &*it;
}

}  // namespace edged

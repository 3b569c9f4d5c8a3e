// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/step.hpp"

#include <algorithm>
#include <array>

#include "edged/camera/output_frame.hpp"

namespace edged {

std::string to_string(TrackingStatus status) {
  constexpr std::array kNames = {"Initializing", "Good", "Degraded", "Lost"};
  return kNames.at(static_cast<std::size_t>(status));
}

bool is_tracking(TrackingStatus status) { return status == TrackingStatus::Good || status == TrackingStatus::Degraded; }

StampedPose Step::pose_of(const std::string& frame) const { return OutputFrame(rig, frame)({t, state.T_W_B}); }

const CameraStep* Step::find(Modality modality) const {
  const auto it = std::ranges::find(cameras, modality, &CameraStep::modality);
  return it == cameras.end() ? nullptr : &*it;
}

const CameraStep* Step::find(std::string_view camera) const {
  const auto it = std::ranges::find(cameras, camera, &CameraStep::name);
  return it == cameras.end() ? nullptr : &*it;
}

}  // namespace edged

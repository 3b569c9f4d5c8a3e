// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/camera_poses.hpp"

namespace edged {

CameraPoses::CameraPoses(const Window& window) : states_(window.states().size()) {
  views_.reserve(window.cameras().size() * states_);
  for (const WindowCamera& by : window.cameras()) {
    const CameraOnBody& camera = cameras_.emplace_back(by.given.T_B_C, by.calibration.data());
    for (const auto& [id, state] : window.states()) views_.emplace_back(camera, state.T_O_B(), state.rate());
  }
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The pose of every camera at every state of a window.
#pragma once

#include <vector>

#include "edged/estimator/factors/landmark_factor.hpp"
#include "edged/estimator/window/window.hpp"

namespace edged {

/// Camera poses, computed once for all observations.
class CameraPoses {
 public:
  explicit CameraPoses(const Window& window);

  /// `place` is that of the state in the window, the oldest being 0.
  CameraView at(std::size_t camera, std::size_t place) const {
    return {cameras_[camera], views_[camera * states_ + place]};
  }

 private:
  std::size_t states_;
  std::vector<CameraOnBody> cameras_;
  std::vector<CameraAt> views_;
};

}  // namespace edged

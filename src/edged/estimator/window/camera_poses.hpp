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
  /// Poses at the present values.
  explicit CameraPoses(const Window& window);
  /// Poses with the states at their Window::linearisation_point.
  static CameraPoses at_first_estimates(const Window& window);

  /// `place` is that of the state in the window, the oldest being 0.
  CameraView at(std::size_t camera, std::size_t place) const {
    return {cameras_[camera], views_[camera * states_ + place]};
  }
  /// The step from the pose that was taken to the present one.
  const Vector6d& moved(std::size_t place) const { return moved_[place]; }

 private:
  CameraPoses(const Window& window, const std::vector<SE3>& poses);

  std::size_t states_;
  std::vector<CameraOnBody> cameras_;
  std::vector<CameraAt> views_;
  std::vector<Vector6d> moved_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The pose of every camera at every state of a window.
#pragma once

#include <vector>

#include "edged/estimator/factors/landmark_factor.hpp"
#include "edged/estimator/window/window.hpp"

namespace edged {

/// Camera poses, computed once for all observations.
class CameraViews {
 public:
  /// At the present values.
  explicit CameraViews(const Window& window);
  /// With the states' poses at Window::linearisation_point.
  static CameraViews at_first_estimates(const Window& window);

  /// place: of the state in the window, the oldest being 0.
  CameraView at(std::size_t camera, std::size_t place) const {
    return {cameras_[camera], views_[camera * states_ + place]};
  }
  /// From the pose that was taken to the present one.
  const Vector6d& moved(std::size_t place) const { return moved_[place]; }

 private:
  CameraViews(const Window& window, const std::vector<SE3>& poses);

  std::size_t states_;
  std::vector<CameraOnBody> cameras_;
  std::vector<CameraAt> views_;
  std::vector<Vector6d> moved_;
};

}  // namespace edged

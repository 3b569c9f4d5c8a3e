// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A feature that is tracked through the images of one camera.
#pragma once

#include <Eigen/Core>

#include "edged/state.hpp"
#include "edged/time.hpp"

namespace edged {

struct Track {
  FeatureId id = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();           ///< in the newest image
  Eigen::Vector2d point = Eigen::Vector2d::Zero();           ///< `pixel` on the unit plane
  Eigen::Vector2d previous_pixel = Eigen::Vector2d::Zero();  ///< in the image before
  Eigen::Vector2d previous_point = Eigen::Vector2d::Zero();
  Eigen::Vector2d keyframe_pixel = Eigen::Vector2d::Zero();  ///< at the last keyframe; only when in_keyframe
  Eigen::Vector2d keyframe_point = Eigen::Vector2d::Zero();
  bool in_keyframe = false;  ///< existed at the last keyframe
  int age = 0;               ///< number of images in which it has been tracked
  Timestamp first_seen;
};

}  // namespace edged

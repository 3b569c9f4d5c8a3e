// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is left of a keyframe when it leaves the window.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "edged/state.hpp"

namespace edged {

/// A landmark as a keyframe saw it.
struct KeyframePoint {
  FeatureId id = 0;
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  ///< on the unit plane of the camera
  double inverse_depth = 0.0;                       ///< of z there [1/m]
  double sigma = 0.0;                               ///< of inverse_depth, by the view that tells it best
};

/// What one camera of the rig saw.
struct KeyframeView {
  std::string camera;
  SE3 T_B_C;  ///< as calibrated then, at the instant of its image
  std::vector<KeyframePoint> points;
};

/// A keyframe by all that the window has learnt of it.
struct KeyframeRecord {
  Timestamp t;
  SE3 T_W_B;
  std::vector<KeyframeView> views;
};

}  // namespace edged

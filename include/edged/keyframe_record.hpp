// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the window has estimated of a keyframe when it is marginalized.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "edged/state.hpp"

namespace edged {

/// A landmark as observed in a keyframe.
struct KeyframePoint {
  FeatureId id = 0;
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  ///< on the unit plane of the camera
  double inverse_depth = 0.0;                       ///< inverse z-depth there [1/m]
  double sigma = 0.0;                               ///< sigma of inverse_depth, from the best-conditioned observation
};

/// The observations of one camera of the rig.
struct KeyframeView {
  std::string camera;
  SE3 T_B_C;  ///< as calibrated then, at the instant of its image
  std::vector<KeyframePoint> points;
};

/// All that the window has estimated of a keyframe.
struct KeyframeRecord {
  Timestamp t;
  SE3 T_W_B;
  std::vector<KeyframeView> views;
};

}  // namespace edged

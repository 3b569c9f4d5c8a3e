// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Corners as the estimator sees them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "edged/state.hpp"

namespace edged {

/// One tracked corner in one image, as the estimator sees it.
struct FeatureObservation {
  FeatureId id = 0;
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  ///< undistorted, on the unit plane z = 1 of its camera
  double sigma = 0.0;  ///< standard deviation of each coordinate of point (px / focal length)
};

/// What one camera of the rig saw at one instant.
struct CameraObservations {
  std::string camera;
  std::vector<FeatureObservation> features;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Observations of features, the input of the estimator.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "edged/state.hpp"

namespace edged {

/// The observation of one feature in one image.
struct FeatureObservation {
  FeatureId id = 0;
  Eigen::Vector2d point = Eigen::Vector2d::Zero();  ///< undistorted, on the unit plane z = 1 of its camera
  double sigma = 0.0;  ///< standard deviation of each coordinate of point (px / focal length)
};

/// The observations of one camera of the rig at one instant.
struct CameraObservations {
  std::string camera;
  std::vector<FeatureObservation> features;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Observations of features and of depth, the input of the estimator.
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

/// The depth of a region of one camera's view at the time of a packet, from a depth source (paper Eq. 5). The source
/// must not have it from the landmarks.
struct RegionDepth {
  std::string camera;
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();  ///< region on the unit plane
  double depth_m = 0.0;                                                           ///< median z-depth
  double sigma_ln = 0.0;   ///< sigma of ln depth_m, with the scale error of the source
  double spread_ln = 0.0;  ///< spread of ln depth within the region
};

}  // namespace edged

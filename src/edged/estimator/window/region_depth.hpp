// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The depth of a region of the view, from a depth source (paper Eq. 5).
#pragma once

#include <Eigen/Core>
#include <string>

namespace edged {

/// The depth of a region of one camera's view at the time of a packet. The source must not have it from the landmarks.
struct RegionDepth {
  std::string camera;
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();  ///< features on the unit plane
  double depth_m = 0.0;                                                           ///< median z-depth
  double sigma_ln = 0.0;   ///< of ln depth_m, with the scale error of the source
  double spread_ln = 0.0;  ///< of ln depth within the region
};

}  // namespace edged

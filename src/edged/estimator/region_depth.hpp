// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a depth source says of a part of the view (paper Eq. 5).
#pragma once

#include <Eigen/Core>
#include <string>

namespace edged {

/// The depth of a region of one camera's view at the time of a packet. The source must not have it from the landmarks.
struct RegionDepth {
  std::string camera;
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();  ///< features on the unit plane
  double depth_m = 0.0;                                                           ///< median z-depth
  double sigma_ln = 0.0;   ///< of ln depth_m, what the source's scale is off included
  double spread_ln = 0.0;  ///< of ln depth within the region
};

/// ln s of Eq. 5 and how well it is known; s is what the source's depths are too large by.
struct LogScale {
  double value = 0.0, sigma = 0.0;
};

}  // namespace edged

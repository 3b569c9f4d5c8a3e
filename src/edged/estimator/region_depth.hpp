// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a depth source says of a part of the view, and how the estimator weighs it (paper Eq. 5).
#pragma once

#include <Eigen/Core>
#include <string>

#include "edged/core/config.hpp"
#include "edged/estimator/factors/depth_factor.hpp"

namespace edged {

/// The depth of a region of one camera's view at the time of a packet. The source must not have it from the landmarks.
struct RegionDepth {
  std::string camera;
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high = Eigen::Vector2d::Zero();  ///< corners on the unit plane
  double depth_m = 0.0;                                                           ///< median z-depth
  double sigma_ln = 0.0;   ///< of ln depth_m, what the source's scale is off included
  double spread_ln = 0.0;  ///< of ln depth within the region
};

/// ln s of Eq. 5 and how well it is known; s is what the source's depths are too large by.
struct LogScale {
  double value = 0.0, sigma = 0.0;
};

struct DepthFactorConfig {
  bool enabled = false;
  DepthResidual form = DepthResidual::Log;
  double scale_sigma = 0.5;     ///< of ln s before anything is known
  double scale_walk = 0.02;     ///< [1/sqrt(s)]
  double noise_share = 0.5;     ///< of the source's sigma_ln: what changes with time and s cannot explain
  double min_interval_s = 0.5;  ///< between two factors: what the source gets wrong lasts
  int min_landmarks = 8;        ///< in the region
  double gate = 3.0;            ///< [sigma]
  double cauchy_scale = 1.0;    ///< [sigma]

  void visit(ConfigFields& fields);
};

}  // namespace edged

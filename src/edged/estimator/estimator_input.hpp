// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the estimator is given.
#pragma once

#include <optional>
#include <vector>

#include "edged/core/observation.hpp"
#include "edged/estimator/region_depth.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// One packet as the estimator sees it.
struct EstimatorInput {
  Timestamp t;
  /// From the previous input's t to t, best around the biases of the newest estimate: others are integrated again.
  Preintegration motion;
  std::vector<CameraObservations> observations;
  bool keyframe = false;
  bool events_quiet = false;                        ///< the event camera sees nothing move
  std::optional<RegionDepth> depth = std::nullopt;  ///< for Eq. 5, used at keyframes when depth_factor is enabled
  std::vector<ExternalSample> external = {};        ///< of the same interval, in time order
};

}  // namespace edged

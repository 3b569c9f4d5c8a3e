// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The input of the estimator.
#pragma once

#include <optional>
#include <vector>

#include "edged/core/observation.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// One packet, as input of the estimator.
struct EstimatorInput {
  Timestamp t;
  /// IMU from the previous input's t to t, if possible with the biases of the newest estimate: otherwise it is
  /// integrated again.
  Preintegration motion;
  std::vector<CameraObservations> observations;
  bool keyframe = false;
  bool events_quiet = false;                        ///< the view of the event camera is static
  std::optional<RegionDepth> depth = std::nullopt;  ///< for Eq. 5, used at keyframes when depth_factor is enabled
  std::vector<ExternalSample> external = {};  ///< after the previous input's t, up to t; in the order of their stamps
};

}  // namespace edged

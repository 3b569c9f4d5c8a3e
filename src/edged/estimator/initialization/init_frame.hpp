// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The input of initialization: views with the IMU between them, and the magnitude of gravity.
#pragma once

#include <optional>
#include <vector>

#include "edged/core/observation.hpp"
#include "edged/estimator/window/region_depth.hpp"
#include "edged/measurement.hpp"

namespace edged {

inline constexpr double kGravity = 9.81;  ///< [m/s^2]

/// One view of the start-up buffer.
struct InitFrame {
  Timestamp t;
  std::vector<ImuSample> imu;  ///< from the frame before to t; of the first frame unused
  std::vector<CameraObservations> observations;
  std::optional<RegionDepth> depth = std::nullopt;  ///< not used by the alignment, but by the window made from it
  std::vector<ExternalSample> external = {};        ///< within `imu`, in the order of their stamps
};

}  // namespace edged

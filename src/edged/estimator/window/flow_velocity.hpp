// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The velocity of a body whose tracks show no parallax each, from all of them together.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "edged/estimator/window/window.hpp"

namespace edged {

struct FlowVelocity {
  Eigen::Vector3d v_O;  ///< of the body, the mean over the tracks' durations [m/s]
  double sigma;  ///< of all directions together, by the scatter of the tracks and a depth wrong by a factor [m/s]
};

/// The velocity that the tracks without a landmark in the newest state show together before a scene of that depth [m]:
/// how their rays turn but for the rotations of the states, which the gyroscope knows. A hundred tracks show a tenth of
/// the parallax that each needs to become a landmark. Nothing with fewer than min_features.
std::optional<FlowVelocity> flow_velocity(const Window& window, double depth_m);

}  // namespace edged

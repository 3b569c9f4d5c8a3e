// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The constants of the scene depth that are no options: unit, effect, and where each value comes from.
#pragma once

#include <chrono>

#include "edged/time.hpp"

namespace edged {

/// Measured on the scenes of docs/depth_model.md.
struct SceneDepthTuning {
  int min_landmarks = 5;                      ///< in the region, for a measurement
  double min_events_per_pixel = 0.05;         ///< in what the network sees, for a measurement
  Duration memory = std::chrono::seconds(5);  ///< time without events after which a recurrent network is reset
  double constant_sigma_ln = 0.7;             ///< sigma of ln depth of the constant
  // The scale s of the network, as ln s.
  double scale_sigma = 0.5;               ///< around 0, at first
  double scale_walk = 0.05;               ///< [1/sqrt(s)]
  double scale_measurement_sigma = 0.35;  ///< error of one window, which changes with time
};
inline constexpr SceneDepthTuning kSceneDepthTuning;

}  // namespace edged

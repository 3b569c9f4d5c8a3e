// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A calibration target in the scene.
#pragma once

#include "edged/sim/scene/scene_parts.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

/// A board with the target at (0, 0, 1.3) that faces -x, 0.8 m before a wall with texture 0.
void add_target(Scene& scene, const SceneConfig& config);

}  // namespace edged

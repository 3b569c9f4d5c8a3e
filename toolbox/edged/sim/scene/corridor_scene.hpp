// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Corridors of a building, or the streets of a block, along a path.
#pragma once

#include <span>

#include "edged/se3.hpp"
#include "edged/sim/random.hpp"
#include "edged/sim/scene/scene_parts.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

/// Corridors of twice config.wall_m, where the path leads: the plan consists of square cells, one with its centre at
/// the first pose. Each panel of a wall, floor or ceiling has its own part of a texture, so that no place resembles
/// another. Boxes stand along the walls.
void add_corridors(Scene& scene, const SceneConfig& config, std::span<const SE3> path_W_C, Random& random);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The scene: textured rectangles that form a room with boxes or a single wall.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "edged/se3.hpp"
#include "edged/sim/disturbance.hpp"
#include "edged/sim/scene/scene_parts.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

/// The scene around a camera path: a closed room around it, with objects that keep their distance from it; a wall in
/// front of it, perpendicular to the mean optical axis; a hall, in which only the furniture depends on the path; or
/// corridors along it.
/// disturbance (with its defaults set): adds a blank wall (in a room only, the half at -x), a person who passes in
/// front of the camera at T_W_C_meeting, walkers in front of the mean camera position, a lamp with a moving spot, or
/// flicker of the lamps.
Scene make_scene(const SceneConfig& config, std::span<const SE3> path_W_C, std::uint64_t seed,
                 const Disturbance& disturbance = {}, const SE3& T_W_C_meeting = {}, const FlickerConfig& flicker = {});

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The motion of the simulated body: smooth random motion, a recorded one, or the flight of a quadrotor.
#pragma once

#include <cstdint>
#include <string>

#include "edged/sim/motion/trajectory.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

/// The motion of the body for duration_s seconds. Random motion moves the camera around a point 1.3 m above the ground,
/// with its mean axis level and along +x. The length of a flight does not depend on duration_s. Throws InputError if
/// the file is too short.
ContinuousTrajectory make_motion(const MotionConfig& config, double duration_s, const SE3& T_B_C, std::uint64_t seed);

}  // namespace edged

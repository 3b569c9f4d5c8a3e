// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How a quadrotor flies: take-off, a named manoeuvre, landing, its tilt following its acceleration.
#pragma once

#include <cstdint>

#include "edged/state.hpp"

namespace edged {

/// Circle: three laps of 1.6 m radius, heading along them. Aggressive: fast shifts to the sides with the roll that they
/// take. Square: two laps of four legs with a stop and a quarter turn at each corner. Line: to and fro along x. Turned:
/// slow path, fast changes of yaw. Free: loops with swaying yaw.
enum class Manoeuvre { None, Circle, Aggressive, Square, Line, Turned, Free };

/// T_W_B at 100 Hz from the instant of take-off until 1 s after the landing; at rest at both ends, 0.25 m above the
/// floor, within 2.3 m of the vertical axis through the origin of a hall. B: x forward, y left, z up. The seed
/// determines the wobble of the drone. manoeuvre: not None.
Trajectory fly(Manoeuvre manoeuvre, std::uint64_t seed);

/// From take-off to touch-down [s].
double airborne_s(Manoeuvre manoeuvre);

}  // namespace edged

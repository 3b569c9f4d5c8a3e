// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The flight of a quadrotor: take-off, a manoeuvre and landing, with a tilt that follows from the acceleration.
#pragma once

#include <cstdint>

#include "edged/sim/simulator_config.hpp"
#include "edged/state.hpp"

namespace edged {

/// T_W_B at 100 Hz from the instant of take-off until 1 s after the landing; at rest at both ends, 0.25 m above the
/// floor, within 2.3 m of the vertical axis through the origin of a hall. B: x forward, y left, z up. The seed
/// determines the wobble of the drone, the wind its size: 1 for that of its controller alone. manoeuvre: not None.
Trajectory fly(Manoeuvre manoeuvre, std::uint64_t seed, double wind = 1.0);

}  // namespace edged

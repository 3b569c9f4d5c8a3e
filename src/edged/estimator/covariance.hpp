// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the window knows of one of its states, and how well.
#pragma once

#include <optional>

#include "edged/estimator/window.hpp"

namespace edged {

/// Covariance of a state: position [m] in the window's world, rotation [rad] (right perturbation, body axes), velocity
/// [m/s], gyro bias [rad/s], accelerometer bias [m/s^2], in this order. Position and yaw are relative to the start, where
/// the gauge is held. The marginal of the whole window; nothing when a direction of it is not determined.
std::optional<Matrix15d> covariance(Window& window, StateId state);

}  // namespace edged

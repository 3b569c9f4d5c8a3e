// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Covariances of the estimates of the window.
#pragma once

#include <optional>
#include <set>

#include "edged/estimator/window/window.hpp"

namespace edged {

/// Covariance of some blocks over their tangent spaces, stacked in the order of their keys: the marginal of the whole
/// window. Nothing if a direction is not observable, or a block is in no factor.
std::optional<Eigen::MatrixXd> covariance(const Window& window, const std::set<BlockKey>& blocks);

/// Covariance of a state: position [m] in the window's frame, rotation [rad] (right perturbation, body axes), velocity
/// [m/s], gyro bias [rad/s], accelerometer bias [m/s^2], in this order. Position and yaw are relative to the start,
/// where the gauge is fixed.
std::optional<Matrix15d> covariance(const Window& window, StateId state);

/// Estimate of ln s, given all measurements so far.
LogScale estimate_scale(const Window& window);

}  // namespace edged

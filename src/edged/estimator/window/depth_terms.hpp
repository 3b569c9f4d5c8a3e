// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Depth in the window (paper Eq. 5): the landmarks that represent a region, the factors on them, and the scale s.
//
// s is the factor by which depths of the source are too large: inverse depth of the scene = s * (1 / depth of the
// source). It is estimated as ln s, one value for the whole window; its random walk acts at the oldest keyframe, when
// that is marginalized.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "edged/estimator/factors/factor.hpp"
#include "edged/estimator/window/window.hpp"

namespace edged {

/// Whether a depth factor is due at the newest state.
bool depth_due(const Window& window);

/// The factor of every state with a depth and enough landmarks in its region. A median has no derivative: the factor
/// takes the mean over the landmarks around it, the middle half but twelve at most, chosen anew at every call.
void add_depth_factors(const Window& window, std::vector<std::shared_ptr<const Factor>>& out);

/// Residual of a depth at a state over its standard deviation, that of s included; nothing without enough landmarks.
std::optional<double> depth_error_sigmas(const Window& window, StateId state, const RegionDepth& depth,
                                         const LogScale& scale);

/// The largest depth_error_sigmas over the depths in the window; 0 without any.
double worst_depth_error(const Window& window, const LogScale& scale);

}  // namespace edged

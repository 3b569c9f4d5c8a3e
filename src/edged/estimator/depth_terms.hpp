// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Depth in the window (paper Eq. 5): which landmarks stand for a region, the factors on them, and the scale s.
//
// s is what the source's depths are too large by: inverse depth of the scene = s * (1 / depth of the source). It is
// held as ln s, one value for the whole window; its random walk acts at the window's old end, where a keyframe leaves.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "edged/estimator/factors/factor.hpp"
#include "edged/estimator/window.hpp"

namespace edged {

/// Whether it is time for another depth, that of the newest state.
bool depth_due(const Window& window);

/// The factor of every state with a depth and enough landmarks in its region. A median has no derivative: the factor
/// takes the mean over the landmarks around it, the middle half but twelve at most, chosen anew at every call.
void add_depth_factors(const Window& window, std::vector<std::shared_ptr<const Factor>>& out);

/// Residual of a depth at a state over its standard deviation, that of s included; nothing without enough landmarks.
std::optional<double> depth_error_sigmas(const Window& window, StateId state, const RegionDepth& depth,
                                         const LogScale& scale);

/// The largest of these over the depths in the window; 0 without any.
double worst_depth_error(const Window& window, const LogScale& scale);

}  // namespace edged

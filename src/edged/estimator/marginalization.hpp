// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Marginalisation: turns factors and the blocks that leave into a prior on the blocks that stay.
#pragma once

#include <set>
#include <vector>

#include "edged/estimator/factors/factor.hpp"
#include "edged/estimator/window.hpp"

namespace edged {

/// Linearises `factors` and eliminates the blocks in `leaving` by Schur complement. Residuals are taken at the present
/// values, Jacobians at the first estimates (Window::linearisation_point), so that directions the measurements cannot
/// see stay unseen. Robust losses act with their present weight. Returns the prior on the remaining blocks, at their
/// linearisation points; `factors` must hold every term that touches a leaving block, the old prior included.
LinearPrior marginalize(Window& window, const std::vector<Factor>& factors, const std::set<BlockKey>& leaving);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Marginalisation: turns factors and the blocks that leave into a prior on the blocks that stay.
#pragma once

#include <set>

#include "edged/estimator/cost.hpp"

namespace edged {

/// Linearises `cost` (Linearisation::FirstEstimates) and eliminates by Schur complement the blocks in `leaving` and all
/// inverse depths that it is of. Returns the prior on the remaining blocks, at their linearisation points; `cost` must
/// hold every term that touches a leaving block, the old prior included.
LinearPrior marginalize(const Window& window, const Cost& cost, const std::set<BlockKey>& leaving);

}  // namespace edged

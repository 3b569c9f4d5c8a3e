// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Marginalization: turns the factors of removed blocks into a prior on the remaining blocks.
#pragma once

#include <set>

#include "edged/estimator/window/cost.hpp"

namespace edged {

/// Linearises `cost` and eliminates by Schur complement the blocks in `leaving` and all inverse depths in it. Returns
/// the prior on the remaining blocks, at their present values; `cost` must hold every term of a block in `leaving`, the
/// old prior included.
LinearPrior marginalize(const Window& window, const Cost& cost, const std::set<BlockKey>& leaving);

}  // namespace edged

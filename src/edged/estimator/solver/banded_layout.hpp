// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The order of the blocks of a window of any length, in which its normal equations are a band with a border.
#pragma once

#include "edged/estimator/solver/linear_system.hpp"
#include "edged/estimator/window/cost.hpp"

namespace edged {

/// States in order of time, each a motion and a pose, are coupled as far as their landmarks are observed. Poses that a
/// factor couples to far later ones, as map matches do, and then the calibrations come last: their rows are long, those
/// of all others are not.
Layout banded_layout(const Window& window, const Cost& cost);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// From the terms of a window to its normal equations: the same for solving, marginalising and covariance.
#pragma once

#include "edged/estimator/cost.hpp"
#include "edged/estimator/linear_system.hpp"

namespace edged {

/// Linearises the terms. Robust losses act with their present weight; what is not defined at the present values (a
/// landmark behind a camera) counts nothing. Inverse depths that the layout does not hold are eliminated, and what
/// their steps follow from is added to `eliminated` if there is one.
NormalEquations normal_equations(const Window& window, const Cost& cost, const Layout& layout, Linearisation at,
                                 std::vector<DepthEquation>* eliminated = nullptr);

/// Half the sum of squares, robust losses applied, at the present values; infinite where a term is not defined.
double value_of(const Window& window, const Cost& cost);

}  // namespace edged

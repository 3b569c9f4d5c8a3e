// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The normal equations of a window's terms, for solving, marginalization and covariance.
#pragma once

#include "edged/estimator/solver/landmark_equations.hpp"
#include "edged/estimator/solver/linear_system.hpp"
#include "edged/estimator/window/cost.hpp"

namespace edged {

/// Linearises the terms at the present values. Robust losses act with their present weight; terms that are not defined
/// at the present values (a landmark behind a camera) are skipped. Inverse depths that are not in the layout are
/// eliminated, and added to `eliminated`, if given, for their steps.
NormalEquations normal_equations(const Window& window, const Cost& cost, const Layout& layout,
                                 std::vector<DepthEquation>* eliminated = nullptr, Purpose purpose = Purpose::Solution);

/// The gradient of the terms alone, at the present values. The inverse depths are eliminated by their equations of an
/// earlier linearization of the same cost, whose gradients are replaced.
Eigen::VectorXd gradient(const Window& window, const Cost& cost, const Layout& layout,
                         std::vector<DepthEquation>& eliminated);

/// Half the sum of squares, robust losses applied, at the present values; infinite where a term is not defined.
double value_of(const Window& window, const Cost& cost);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// From the terms of a window to its normal equations: the same for solving, marginalising and covariance.
#pragma once

#include "edged/estimator/cost.hpp"
#include "edged/estimator/linear_system.hpp"

namespace edged {

/// Where Jacobians are taken; residuals always at the present values. FirstEstimates: at the
/// Window::linearisation_point of each block, so that directions the measurements cannot see stay unseen; d then counts
/// from there.
enum class Linearisation { Present, FirstEstimates };

/// What is needed to find a landmark's inverse depth again: its step is -(g + coupling^T d) / h.
struct EliminatedDepth {
  double* inverse_depth;
  double h, g;
  Eigen::VectorXd coupling;     ///< over the columns of `blocks`
  std::vector<Placed> blocks;
};

/// Linearises the terms. Robust losses act with their present weight; what is not defined at the present values (a
/// landmark behind a camera) counts nothing. Inverse depths that the layout does not hold are eliminated, and what
/// their steps follow from is added to `eliminated` if there is one.
NormalEquations normal_equations(Window& window, const Cost& cost, const Layout& layout, Linearisation at,
                                 std::vector<EliminatedDepth>* eliminated = nullptr);

/// Half the sum of squares, robust losses applied, at the present values; infinite where a term is not defined.
double value_of(Window& window, const Cost& cost);

}  // namespace edged

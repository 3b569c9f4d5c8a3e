// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The normal equations of a set of factors, with what is to be eliminated in front.
#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <vector>

#include "edged/estimator/factors/factor.hpp"
#include "edged/estimator/window.hpp"

namespace edged {

/// H d = -g of all factors, over the tangent steps d from the blocks' linearisation points. Ordered: leaving inverse
/// depths that couple with no other, the other leaving blocks, the staying blocks.
struct NormalEquations {
  std::map<BlockKey, Eigen::Index> offset;
  std::vector<BlockKey> staying;
  Eigen::Index depths = 0;   ///< columns of the inverse depths in front
  Eigen::Index leaving = 0;  ///< columns of all that leaves
  Eigen::Index size = 0;
  Eigen::MatrixXd H;
  Eigen::VectorXd g;
};

/// Linearises the factors: residuals at the present values, Jacobians at the first estimates
/// (Window::linearisation_point), so that directions the measurements cannot see stay unseen. Robust losses act with
/// their present weight. The inverse depths in front are eliminated already: only what is behind them in H and g
/// counts.
NormalEquations normal_equations(Window& window, const std::vector<Factor>& factors, const std::set<BlockKey>& leaving);

/// S with ones on the diagonal of S H S, zero where nothing was measured: positions, angles and biases differ in
/// information by ten orders of magnitude.
Eigen::VectorXd unit_diagonal_scale(const Eigen::MatrixXd& H);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/walking_scalar.hpp"

#include <algorithm>
#include <cmath>

namespace edged {

LinearPrior WalkingScalar::begin_piece(double dt_s) {
  const auto [id, value] = *pieces_.rbegin();
  pieces_.emplace(id + 1, value);
  // Without a random walk a piece equals the one before, up to rounding.
  const double sigma = std::max(1e-4, walk_per_root_s_ * std::sqrt(dt_s));
  LinearPrior walk;
  walk.blocks = {{kind_, id}, {kind_, id + 1}};
  walk.x0 = {{value}, {value}};
  walk.J = Eigen::RowVector2d(-1.0, 1.0) / sigma;
  walk.r = Eigen::VectorXd::Zero(1);
  return walk;
}

}  // namespace edged

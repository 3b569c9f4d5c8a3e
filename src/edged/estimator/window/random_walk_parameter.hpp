// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A scalar of the window with a random walk: the scale of a depth source, the level of a height sensor.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>

#include "edged/estimator/factors/linear_prior.hpp"

namespace edged {

/// The initial uncertainty of a scalar and its random walk.
struct RandomWalk {
  double sigma;
  double per_root_s;  ///< [1/sqrt(s)] times the unit of the scalar
};

/// One value for the whole window. The random walk acts at the oldest state: a marginalized keyframe takes the present
/// block with it, and a new block begins at its value.
class RandomWalkParameter {
 public:
  /// first: number of its first block.
  RandomWalkParameter(BlockKind kind, std::uint64_t first, double value, double walk_per_root_s)
      : kind_(kind), walk_per_root_s_(walk_per_root_s), blocks_{{first, value}} {}

  BlockKey present() const { return {kind_, blocks_.rbegin()->first}; }
  /// The present block, and the one before until it is marginalized.
  const std::map<std::uint64_t, double>& blocks() const { return blocks_; }
  std::map<std::uint64_t, double>& blocks() { return blocks_; }

  /// Begins a new block and returns the random walk factor from the old one to it over a time (docs/math.md, D3).
  LinearPrior propagate(double dt_s) {
    const auto [id, value] = *blocks_.rbegin();
    blocks_.emplace(id + 1, value);
    // Without a random walk a block equals the one before, up to rounding.
    const double sigma = std::max(1e-4, walk_per_root_s_ * std::sqrt(dt_s));
    LinearPrior walk;
    walk.blocks = {{kind_, id}, {kind_, id + 1}};
    walk.x0 = {{value}, {value}};
    walk.J = Eigen::RowVector2d(-1.0, 1.0) / sigma;
    walk.r = Eigen::VectorXd::Zero(1);
    return walk;
  }
  void drop_old() { blocks_.erase(blocks_.begin(), std::prev(blocks_.end())); }

 private:
  BlockKind kind_;
  double walk_per_root_s_;
  std::map<std::uint64_t, double> blocks_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A scalar of the window with a random walk: the scale of a depth source, the level of a height sensor.
#pragma once

#include <cstdint>
#include <map>

#include "edged/estimator/factors/linear_prior.hpp"

namespace edged {

/// The initial uncertainty of a scalar and its random walk.
struct Walk {
  double sigma;
  double per_root_s;  ///< [1/sqrt(s)] times the unit of the scalar
};

/// One value for the whole window, a piece. The random walk acts at the oldest state: a marginalized keyframe takes the
/// present piece with it, and a new piece begins at its value.
class WalkingScalar {
 public:
  WalkingScalar(BlockKind kind, double value, double walk_per_root_s)
      : kind_(kind), walk_per_root_s_(walk_per_root_s), pieces_{{0, value}} {}

  BlockKey present() const { return {kind_, pieces_.rbegin()->first}; }
  /// The present piece, and the one before until it is marginalized.
  const std::map<std::uint64_t, double>& pieces() const { return pieces_; }
  std::map<std::uint64_t, double>& pieces() { return pieces_; }
  /// Begins a new piece and returns the random walk factor from the old one to it over a time (docs/math.md, D3).
  LinearPrior begin_piece(double dt_s);
  void leave_behind() { pieces_.erase(pieces_.begin(), std::prev(pieces_.end())); }

 private:
  BlockKind kind_;
  double walk_per_root_s_;
  std::map<std::uint64_t, double> pieces_;
};

}  // namespace edged

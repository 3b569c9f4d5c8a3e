// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A scalar of the window that walks at random: the scale of a depth source, the level of a height sensor.
#pragma once

#include <cstdint>
#include <map>

#include "edged/estimator/factors/linear_prior.hpp"

namespace edged {

/// How well a scalar is known at first, and how fast it walks.
struct Walk {
  double sigma;
  double per_root_s;  ///< [1/sqrt(s)] times the unit of the scalar
};

/// One value for the whole window, a piece. The walk acts at the window's old end: a keyframe that leaves takes the
/// present piece with it, and another begins where that one is.
class WalkingScalar {
 public:
  WalkingScalar(BlockKind kind, double value, double walk_per_root_s)
      : kind_(kind), walk_per_root_s_(walk_per_root_s), pieces_{{0, value}} {}

  BlockKey present() const { return {kind_, pieces_.rbegin()->first}; }
  /// The present piece, and the one before until it is left behind.
  const std::map<std::uint64_t, double>& pieces() const { return pieces_; }
  std::map<std::uint64_t, double>& pieces() { return pieces_; }
  /// Begins another piece and returns the walk from the one before to it over a time (docs/math.md, D3).
  LinearPrior begin_piece(double dt_s);
  void leave_behind() { pieces_.erase(pieces_.begin(), std::prev(pieces_.end())); }

 private:
  BlockKind kind_;
  double walk_per_root_s_;
  std::map<std::uint64_t, double> pieces_;
};

}  // namespace edged

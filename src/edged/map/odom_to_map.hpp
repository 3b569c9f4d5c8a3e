// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The only owner of T_M_O, the pose of the odometry frame O in the map frame M, and of its history. Each start of the
// estimator begins a new O: the first one defines M, later ones are placed by dead reckoning, and the map corrects
// them.
#pragma once

#include <cstddef>
#include <vector>

#include "edged/core/odom_state.hpp"
#include "edged/se3.hpp"
#include "edged/state.hpp"
#include "edged/time.hpp"

namespace edged {

/// Calls come in order of time.
class OdomToMap {
 public:
  /// The estimator has started in a new O. T_new_old: from the old O to the new one; now: the body in the new one.
  /// Position and yaw go on; tilt is the estimator's, which knows gravity.
  void restart(const SE3& T_new_old, const OdomState& now);
  /// O goes on where it is, but its place in M is a guess again.
  void restart(Timestamp t);
  /// The map has placed O at T_M_O, from t on.
  void correct(Timestamp t, const SE3& T_M_O);
  /// The guess of the newest start was far off: its newest placement holds for all its time.
  void forget_guess();
  /// All starts before the newest lay in another frame than M.
  void move_before(const SE3& T_M_before);
  /// What follows goes on from here, with a history of its own.
  void forget_history() { starts_.clear(); }

  const SE3& T_M_O() const { return T_M_O_; }
  /// As it was at t, in the time of that start of the history.
  const SE3& T_M_O(std::size_t start, Timestamp t) const;

  NavState in_map(const OdomState& in_O) const;
  std::vector<Landmark> in_map(std::vector<Landmark> in_O) const;

 private:
  SE3 T_M_O_;
  bool started_ = false;
  std::vector<Trajectory> starts_;  ///< T_M_O and the time from which on it holds, one or more a start
};

}  // namespace edged

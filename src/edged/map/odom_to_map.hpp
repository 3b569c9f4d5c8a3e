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
  /// Position and yaw are continuous; tilt is that of the estimator, which observes gravity.
  void restart(const SE3& T_new_old, const OdomState& now);
  /// O stays where it is, but its pose in M is uncertain again.
  void restart(Timestamp t);
  /// The map has corrected T_M_O, from t on.
  void correct(Timestamp t, const SE3& T_M_O);
  /// The dead reckoning to the newest start was far off: its newest T_M_O replaces all since that start.
  void drop_dead_reckoning();
  /// All starts before the newest lay in another frame than M.
  void transform_earlier(const SE3& T_M_before);
  /// Starts a new history from here.
  void clear_history() { starts_.clear(); }

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

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Where the estimator's own frame S lies in the world W. Each start of the estimator begins a new S: the first makes it
// the world, later ones are put where the dead reckoning has come to, so that the trajectory goes on.
#pragma once

#include <vector>

#include "edged/keyframe_record.hpp"
#include "edged/state.hpp"

namespace edged {

class WorldFrame {
 public:
  /// The estimator has started in a frame of its own. T_new_old: from what S was to what it is now; now: the body in
  /// the new one. Position and yaw go on; tilt is the estimator's, which knows gravity.
  void restart(const SE3& T_new_old, const NavState& now);

  /// The map says where S lies.
  void move(const SE3& T_W_S) { T_W_S_ = T_W_S; }

  NavState of(NavState in_S) const;
  std::vector<Landmark> of(std::vector<Landmark> in_S) const;
  std::vector<KeyframeRecord> of(std::vector<KeyframeRecord> in_S) const;
  const SE3& T_W_S() const { return T_W_S_; }

 private:
  SE3 T_W_S_;
  bool started_ = false;
};

}  // namespace edged

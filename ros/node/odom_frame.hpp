// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The frame `odom` of REP 105: poses in it are continuous, what the map corrects moves it in the frame `map`.
#pragma once

#include "edged/step.hpp"

namespace edged::node {

/// The odometry frame O of Step begins anew with each start of the estimator; this one goes on.
class OdomFrame {
 public:
  /// Each step, in order. Returns by how much it moves the body in the map against odom [m].
  double note(const Step& step);
  /// odom in the map frame M (W of Step).
  SE3 T_M_odom() const { return T_M_O_ * T_odom_O_.inverse(); }

 private:
  SE3 T_M_O_, T_odom_O_, T_odom_B_;  ///< of the last step; T_odom_B_ of the last one with a pose
  bool started_ = false;
};

}  // namespace edged::node

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/odom_frame.hpp"

namespace edged::node {

double OdomFrame::note(const Step& step) {
  const SE3 T_M_odom_before = T_M_odom();
  const SE3 T_O_B = step.T_M_O.inverse() * step.state.T_W_B;
  if (!step.started.empty()) {
    // The new O lies where dead reckoning has brought the body, unless the map has moved both in this very packet.
    if (started_)
      T_odom_O_ = step.relocalized ? T_odom_B_ * T_O_B.inverse() : T_odom_O_ * T_M_O_.inverse() * step.T_M_O;
    started_ = true;
  }
  T_M_O_ = step.T_M_O;
  if (!is_tracking(step.status)) return 0.0;
  T_odom_B_ = T_odom_O_ * T_O_B;
  const Eigen::Vector3d before = T_M_odom_before * T_odom_B_.translation();
  return (step.state.T_W_B.translation() - before).norm();
}

}  // namespace edged::node

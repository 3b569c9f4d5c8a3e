// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/pipeline/world_frame.hpp"

#include <cmath>

namespace edged {

void WorldFrame::restart(const SE3& T_new_old, const NavState& now) {
  if (started_) {
    const SE3 T_Sold_Snew = T_new_old.inverse();
    const Eigen::Matrix3d R = (T_W_S_ * T_Sold_Snew).R();
    const double yaw = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));
    const Eigen::Quaterniond q = so3::exp({0.0, 0.0, yaw});
    const Eigen::Vector3d p_W_B = T_W_S_ * (T_Sold_Snew * now.T_W_B.translation());
    T_W_S_ = SE3(q, p_W_B - q * now.T_W_B.translation());
  }
  started_ = true;
}

NavState WorldFrame::of(NavState in_S) const {
  in_S.T_W_B = T_W_S_ * in_S.T_W_B;
  in_S.v_W = T_W_S_.rotation() * in_S.v_W;
  return in_S;
}

std::vector<Landmark> WorldFrame::of(std::vector<Landmark> in_S) const {
  for (Landmark& landmark : in_S) landmark.p_W = T_W_S_ * landmark.p_W;
  return in_S;
}

std::vector<KeyframeRecord> WorldFrame::of(std::vector<KeyframeRecord> in_S) const {
  for (KeyframeRecord& record : in_S) record.T_W_B = T_W_S_ * record.T_W_B;
  return in_S;
}

}  // namespace edged

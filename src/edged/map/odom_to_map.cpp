// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/map/odom_to_map.hpp"

#include <algorithm>
#include <iterator>

#include "edged/core/directions.hpp"

namespace edged {

void OdomToMap::restart(const SE3& T_new_old, const OdomState& now) {
  if (started_) {
    const SE3 T_Oold_Onew = T_new_old.inverse();
    const Eigen::Quaterniond q = nearest_yaw((T_M_O_ * T_Oold_Onew).R());
    const Eigen::Vector3d p_M_B = T_M_O_ * (T_Oold_Onew * now.T_O_B.translation());
    T_M_O_ = SE3(q, p_M_B - q * now.T_O_B.translation());
  }
  started_ = true;
  restart(now.t);
}

void OdomToMap::restart(Timestamp t) { starts_.push_back({{t, T_M_O_}}); }

void OdomToMap::correct(Timestamp t, const SE3& T_M_O) {
  T_M_O_ = T_M_O;
  starts_.back().push_back({t, T_M_O});
}

void OdomToMap::drop_dead_reckoning() {
  Trajectory& placed = starts_.back();
  placed.erase(placed.begin(), std::prev(placed.end()));
}

void OdomToMap::transform_earlier(const SE3& T_M_before) {
  for (auto start = starts_.begin(); start != std::prev(starts_.end()); ++start) {
    for (StampedPose& placed : *start) placed.T = T_M_before * placed.T;
  }
}

const SE3& OdomToMap::T_M_O(std::size_t start, Timestamp t) const {
  const Trajectory& placed = starts_[start];
  const auto after = std::ranges::upper_bound(placed, t, {}, &StampedPose::t);
  return after == placed.begin() ? after->T : std::prev(after)->T;
}

NavState OdomToMap::in_map(const OdomState& in_O) const {
  return {in_O.t, T_M_O_ * in_O.T_O_B, T_M_O_.rotation() * in_O.v_O, in_O.bias_gyro, in_O.bias_accel};
}

std::vector<Landmark> OdomToMap::in_map(std::vector<Landmark> in_O) const {
  for (Landmark& landmark : in_O) landmark.p_W = T_M_O_ * landmark.p_W;
  return in_O;
}

}  // namespace edged

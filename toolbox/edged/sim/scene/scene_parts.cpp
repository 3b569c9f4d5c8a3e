// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/scene/scene_parts.hpp"

#include <algorithm>
#include <cmath>

namespace edged {

Eigen::Vector3d DynamicObject::displacement(double t_s) const {
  Eigen::Vector3d d = t_s * velocity_W + (std::max(0.0, from_s - t_s) + std::max(0.0, t_s - to_s)) * away_W;
  for (const Swing& swing : swings) d += std::sin(swing.omega * t_s + swing.phase) * swing.reach_W;
  return d;
}

Eigen::Vector3d DynamicObject::velocity(double t_s) const {
  Eigen::Vector3d v = velocity_W + (t_s < from_s ? -1.0 : t_s > to_s ? 1.0 : 0.0) * away_W;
  for (const Swing& swing : swings) v += swing.omega * std::cos(swing.omega * t_s + swing.phase) * swing.reach_W;
  return v;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// For tests: a keyframe with one landmark straight ahead.
#pragma once

#include "edged/keyframe_record.hpp"

namespace edged {

/// At (0.025, 0.025, 0.025), facing x; the landmark is at that x. sigma_m: along the ray.
inline KeyframeRecord keyframe_before(double x, double sigma_m, Timestamp t = {}) {
  Eigen::Matrix3d R_W_C;
  R_W_C << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const double depth = x - 0.025;
  KeyframeRecord keyframe{t, SE3(Eigen::Quaterniond(R_W_C), {0.025, 0.025, 0.025}), {}};
  keyframe.views.push_back({"frames", SE3(), {{1, {0.0, 0.0}, 1.0 / depth, sigma_m / (depth * depth)}}});
  return keyframe;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Motions for the tests of this folder.
#pragma once

#include <cmath>

#include "edged/state.hpp"

namespace edged {

/// A frame that is rotated and shifted against the world.
inline const SE3 kTilted(so3::exp({0.4, -0.7, 1.9}), Eigen::Vector3d(3, -5, 2));

/// A winding motion sampled at rate_hz over duration_s, starting at stamp 100 s: curved in all three axes, turning.
inline Trajectory winding_motion(double duration_s = 20.0, double rate_hz = 50.0) {
  Trajectory trajectory;
  const int n = static_cast<int>(duration_s * rate_hz) + 1;
  for (int i = 0; i < n; ++i) {
    const double t = i / rate_hz;
    const Eigen::Vector3d p(2.0 * std::cos(0.5 * t), 1.5 * std::sin(0.7 * t) + 0.1 * t, 0.5 * std::sin(1.1 * t));
    const Eigen::Vector3d phi(0.4 * std::sin(0.9 * t), 0.3 * std::cos(0.6 * t), 0.8 * std::sin(0.3 * t));
    trajectory.push_back({timestamp_from_seconds(100.0 + t), SE3(so3::exp(phi), p)});
  }
  return trajectory;
}

/// Its velocity [m/s].
inline Eigen::Vector3d winding_velocity(Timestamp stamp) {
  const double t = to_seconds(stamp - timestamp_from_seconds(100.0));
  return {-std::sin(0.5 * t), 1.05 * std::cos(0.7 * t) + 0.1, 0.55 * std::cos(1.1 * t)};
}

/// Every pose multiplied from the left.
inline Trajectory moved(const SE3& T, Trajectory trajectory) {
  for (StampedPose& pose : trajectory) pose.T = T * pose.T;
  return trajectory;
}

inline Trajectory scaled(double factor, Trajectory trajectory) {
  for (StampedPose& pose : trajectory) pose.T.translation() *= factor;
  return trajectory;
}

}  // namespace edged

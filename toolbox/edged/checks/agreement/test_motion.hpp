// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// For tests: the turning of a body that is held in a hand.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace edged {

/// Angular velocity [rad/s] by time [s]: swings about each axis at random rates, whose sum does not repeat.
inline Eigen::Vector3d uneven(double t) {
  struct Swing {
    double hz, phase;
  };
  static const std::vector<std::array<Swing, 3>> kSwings = [] {
    std::mt19937 random(3);
    const auto next = [&random] { return static_cast<double>(random()) / static_cast<double>(std::mt19937::max()); };
    std::vector<std::array<Swing, 3>> swings(40);
    for (auto& axes : swings)
      for (Swing& swing : axes) {
        swing.hz = 0.1 + 2.0 * next();
        swing.phase = 2 * M_PI * next();
      }
    return swings;
  }();
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  for (const auto& axes : kSwings)
    for (int k = 0; k < 3; ++k) {
      const Swing& swing = axes[static_cast<std::size_t>(k)];
      rate[k] += 0.15 * std::sin(2 * M_PI * swing.hz * t + swing.phase);
    }
  return rate;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// For the tests of this folder: random numbers and motions.
#pragma once

#include <random>

#include "edged/se3.hpp"

namespace edged {

/// In [low, high), the same on every machine.
inline double uniform(std::mt19937_64& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

/// Linear, then angular velocity [m/s, rad/s].
inline Vector6d twist(double vx, double vy, double vz, double wx, double wy, double wz) {
  Vector6d xi;
  xi << vx, vy, vz, wx, wy, wz;
  return xi;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A seeded random number generator, whose bits do not depend on the distributions of the standard library.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace edged {

class Random {
 public:
  /// Different streams of one seed are independent, so that parts of the simulator do not affect the random numbers of
  /// others.
  Random(std::uint64_t seed, std::uint64_t stream)
      : engine_(seed * 0x9E3779B97F4A7C15ULL + stream * 0xD1B54A32D192ED03ULL) {}

  /// In [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

  /// In [0, n).
  int index(int n) { return static_cast<int>(uniform() * n); }

  /// Standard normal (Box-Muller, one of the pair).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

  Eigen::Vector3d normal3() {
    const double x = normal(), y = normal(), z = normal();
    return {x, y, z};
  }

  /// A random number of events with this exact mean, which must be well below the number of pixels.
  int arrivals(double mean) {
    const double whole = std::floor(mean);
    return static_cast<int>(whole) + (uniform() < mean - whole ? 1 : 0);
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace edged

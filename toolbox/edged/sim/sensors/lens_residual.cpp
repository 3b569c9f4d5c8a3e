// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/sim/sensors/lens_residual.hpp"

#include <cmath>
#include <numbers>

#include "edged/sim/random.hpp"

namespace edged {
namespace {

constexpr int kWaves = 8;
constexpr double kShortest = 0.5, kLongest = 1.5;  // wavelength over the width of the image

Eigen::Vector2d direction(Random& random) {
  const double angle = 2.0 * std::numbers::pi * random.uniform();
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

LensResidual::LensResidual(double rms_px, int width, std::uint64_t seed) {
  if (rms_px == 0.0) return;
  Random random(seed, 30);
  for (int i = 0; i < kWaves; ++i) {
    const double rad_per_px = 2.0 * std::numbers::pi / (width * random.uniform(kShortest, kLongest));
    const Eigen::Vector2d along = direction(random), to = direction(random);
    // A cosine has an rms of 1 / sqrt(2).
    waves_.push_back(
        {rad_per_px * along, rms_px * std::sqrt(2.0 / kWaves) * to, 2.0 * std::numbers::pi * random.uniform()});
  }
}

Eigen::Vector2d LensResidual::at(const Eigen::Vector2d& pixel) const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Wave& wave : waves_) sum += std::cos(wave.rad_per_px.dot(pixel) + wave.phase) * wave.amplitude_px;
  return sum;
}

}  // namespace edged

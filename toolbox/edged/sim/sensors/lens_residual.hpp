// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the model of a lens leaves over after a calibration: a smooth displacement of the image.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace edged {

/// A sum of plane waves, a half to one and a half times the width of the image long.
class LensResidual {
 public:
  LensResidual() = default;  ///< none
  /// rms_px: of the displacement over the image.
  LensResidual(double rms_px, int width, std::uint64_t seed);

  /// The pixel that the calibrated lens has where this one has the given pixel, less that pixel [px].
  Eigen::Vector2d at(const Eigen::Vector2d& pixel) const;

 private:
  struct Wave {
    Eigen::Vector2d rad_per_px, amplitude_px;
    double phase;
  };
  std::vector<Wave> waves_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The white noise of an IMU as it is now: running motors raise it far above the calibrated one, which was measured at
// rest. What matters for the integral is the density at low frequencies, where the motion of the body is, too.
#pragma once

#include <deque>
#include <vector>

#include "edged/imu_noise.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// Third differences of means over blocks leave out smooth motion and keep white noise. Blocks of 25 ms measure the
/// density that the integral sees, but fast motion as well, so noise counts only as far as shorter blocks, which no
/// motion reaches, show it, too. Medians leave out knocks.
class ImuNoiseEstimator {
 public:
  explicit ImuNoiseEstimator(const ImuNoise& calibrated) : calibrated_(calibrated), noise_(calibrated) {}

  /// Takes the samples of a packet, whose ends are interpolated ones (slice_imu). Returns the noise of the last second:
  /// the calibrated one, or more.
  const ImuNoise& add(const std::vector<ImuSample>& imu);

 private:
  ImuNoise calibrated_, noise_;
  std::deque<ImuSample> samples_;  ///< without gaps
};

}  // namespace edged

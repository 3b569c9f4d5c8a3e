// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The white noise of an IMU as it is now: running motors raise it far above the calibrated one, which was measured at
// rest. What matters for the integral is the density at low frequencies, where the motion of the body is, too.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "edged/imu_noise.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// The noise of an IMU at rest, where all that it measures is noise: a slow IMU shows the vibration of motors as slow
/// oscillations, which only rest distinguishes from motion. Allan deviations of means over as long as states are apart;
/// medians leave out knocks. The calibrated noise where it explains the readings, or where they are too few.
ImuNoise noise_at_rest(std::span<const ImuSample> imu, const ImuNoise& calibrated);

/// Third differences of means over blocks leave out smooth motion and keep white noise. Blocks of 25 ms measure the
/// density that the integral sees, but fast motion as well, so noise counts only as far as shorter blocks, which no
/// motion reaches, show it, too. Medians leave out knocks.
class ImuNoiseEstimator {
 public:
  explicit ImuNoiseEstimator(const ImuNoise& calibrated)
      : calibrated_(calibrated), least_(calibrated), noise_(calibrated) {}

  /// The noise is no less until the next rest: noise_at_rest().
  void set_least(const ImuNoise& at_rest) { least_ = at_rest; }

  /// Takes how an update has changed the velocity that was predicted over dt_s until t [m/s]. In a filter that is tuned
  /// such changes have the variance of the process noise. Where the IMU shakes larger ones mean that its readings shake
  /// slowly, too.
  void add_correction(Timestamp t, const Eigen::Vector3d& dv, double dt_s);

  /// Takes the samples of a packet, whose ends are interpolated ones (slice_imu). Returns the noise of the last second:
  /// the least one, or more.
  const ImuNoise& add(const std::vector<ImuSample>& imu);

 private:
  double growth(double accel_noise) const;

  ImuNoise calibrated_, least_, noise_;
  std::deque<ImuSample> samples_;  ///< without gaps
  struct Correction {
    Timestamp t;
    double per_s;  ///< [m^2/s^3] squared
  };
  std::deque<Correction> corrections_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The error model of an IMU.
#pragma once

namespace edged {

/// Continuous-time densities, as in a Kalibr imu.yaml.
struct ImuNoise {
  double gyro_noise = 1e-3;         ///< [rad/s/sqrt(Hz)]
  double accel_noise = 1e-2;        ///< [m/s^2/sqrt(Hz)]
  double gyro_walk = 1e-5;          ///< [rad/s^2/sqrt(Hz)]
  double accel_walk = 3e-4;         ///< [m/s^3/sqrt(Hz)]
  double gyro_saturation = 34.9;    ///< [rad/s] a rate at or above this on any axis is saturated
  double accel_saturation = 156.9;  ///< [m/s^2]
  /// Factor on the noise where samples are saturated or missing: the error of a clipped rate is its excess over the
  /// range, for as long as it lasts, so the IMU has almost no information there.
  double saturation_inflation = 1e4;

  /// Throws InputError that names the first invalid value: not positive, or not a number.
  void validate() const;
};

}  // namespace edged

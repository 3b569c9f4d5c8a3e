// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// An inertial sensor: true rates and specific force, with noise, bias random walks, vibration and a limited range.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "edged/config.hpp"
#include "edged/imu_noise.hpp"
#include "edged/measurement.hpp"
#include "edged/sim/random.hpp"
#include "edged/sim/trajectory.hpp"

namespace edged {

struct ImuModelConfig {
  double rate_hz = 1000.0;
  double time_offset_ms = 2.4;  ///< t_imu = t_cam + time_offset
  double gyro_noise = 1.2e-4;   ///< [rad/s/sqrt(Hz)]
  double accel_noise = 4e-3;    ///< [m/s^2/sqrt(Hz)]
  double gyro_walk = 1e-5;      ///< [rad/s^2/sqrt(Hz)]
  double accel_walk = 1e-4;     ///< [m/s^3/sqrt(Hz)]
  double gyro_bias = 0.012;     ///< length of each constant bias, its direction is random [rad/s]
  double accel_bias = 0.1;      ///< [m/s^2]
  /// Errors of scale and of the axes' directions, standard deviation of each, of either sensor.
  double scale_error = 0.0;
  double cross_axis_mrad = 0.0;
  double gyro_range = 34.9;    ///< readings end here [rad/s]
  double accel_range = 156.9;  ///< [m/s^2]
  /// The vibration of running motors in the sensor: a narrow band at their speed and half as much at twice of it,
  /// too small for a camera to observe, and a broad band.
  double vibration_hz = 130.0;
  double gyro_vibration = 0.0;   ///< rms of the narrow band on each axis [rad/s]
  double accel_vibration = 0.0;  ///< [m/s^2]
  double gyro_broadband = 0.0;   ///< [rad/s/sqrt(Hz)]
  double accel_broadband = 0.0;  ///< [m/s^2/sqrt(Hz)]
  double motors_on_s = 0.0;      ///< on the camera's clock
  double motors_off_s = 1e6;

  void visit(ConfigFields& fields);

  /// A calibration of this sensor, with the broad band of the vibration; no density is below a
  /// millionth of the default one.
  ImuNoise noise() const;
};

/// Noise around one frequency: white noise through a resonator of 6 Hz, of unit variance.
class Hum {
 public:
  Hum(double hz, double rate_hz);
  double next(Random& random);

 private:
  double a_1_, a_2_, drive_;
  double last_ = 0.0, before_ = 0.0;
};

class ImuModel {
 public:
  ImuModel(const ImuModelConfig& config, std::uint64_t seed);

  /// One sample (Forster 2017, Eq. 27, 28); the biases change by one sample period after it. The samples are taken to
  /// come at rate_hz.
  ImuSample measure(Timestamp t, const Kinematics& truth);

  const Eigen::Vector3d& bias_gyro() const { return bias_gyro_; }
  const Eigen::Vector3d& bias_accel() const { return bias_accel_; }

 private:
  /// Adds the vibration of the motors, scaled by their speed.
  void shake(ImuSample& sample);

  ImuModelConfig config_;
  Random random_, vibration_;
  std::array<Hum, 12> hums_;  // gyroscope, accelerometer; one and twice the frequency
  Eigen::Vector3d bias_gyro_, bias_accel_;
  Eigen::Matrix3d gyro_axes_, accel_axes_;  // measurement matrix: scale and axis errors
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the IMU says of itself: noise, rest and units.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>

#include "edged/core/types.hpp"

namespace edged {

/// The calmest half second of an IMU. Continuous-time densities, from differences of successive samples: there white noise
/// remains, motion does not.
struct ImuCalm {
  Timestamp begin;
  bool at_rest = false;
  double gyro_noise = 0.0;   ///< [rad/s/sqrt(Hz)]
  double accel_noise = 0.0;  ///< [m/s^2/sqrt(Hz)]
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< mean: at rest the gyro's bias [rad/s]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< mean: at rest upwards [m/s^2]
};

struct ImuSurvey {
  std::optional<ImuCalm> calm;             ///< nothing where no half second has 20 samples
  double mean_accel = 0.0;                 ///< length of the specific force [m/s^2]
  double mean_gyro = 0.0, max_gyro = 0.0;  ///< angular speed [rad/s]
};

/// Takes samples in time order. Memory is bounded.
class ImuSurveyor {
 public:
  void add(const ImuSample& sample);
  ImuSurvey result() const;

 private:
  /// Sums over half a second.
  struct Stretch {
    Timestamp begin;
    std::size_t count = 0;
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
    double gyro_squares = 0.0, accel_squares = 0.0;        ///< of all three axes
    double gyro_differences = 0.0, accel_differences = 0.0;  ///< squares of differences of successive samples
    Duration time{0};
    double gyro_deviation() const;
    double accel_deviation() const;
  };

  void end_stretch();

  Stretch current_;
  std::optional<Stretch> calmest_;
  std::optional<ImuSample> last_;
  std::size_t count_ = 0;
  double accel_sum_ = 0.0, gyro_sum_ = 0.0, max_gyro_ = 0.0;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether the biases of the IMU stay where they were. They drift slowly, so a fast change means that the cameras
// contradict the IMU: most features are on a dynamic object, which the biases come to explain.
#pragma once

#include <Eigen/Core>
#include <deque>

#include "edged/core/odom_state.hpp"
#include "edged/imu/preintegration.hpp"
#include "edged/imu_noise.hpp"
#include "edged/time.hpp"

namespace edged {

/// The biases of one start of the estimator, over the last 10 s.
class BiasHistory {
 public:
  explicit BiasHistory(const ImuNoise& noise) : noise_(noise) {}

  /// The largest difference of an axis from what it was before, in sigmas of that time and of the drift since. P: of
  /// the state, as Estimator::covariance has it. States in time order.
  double add(const OdomState& state, const Matrix15d& P);

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  struct Entry {
    Timestamp t;
    Vector6d bias;      ///< of the gyro [rad/s], of the accelerometer [m/s^2]
    Vector6d variance;  ///< at that time
  };

  ImuNoise noise_;
  std::deque<Entry> entries_;
};

}  // namespace edged

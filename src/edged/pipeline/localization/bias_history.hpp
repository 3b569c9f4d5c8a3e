// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether the biases of the IMU stay where they were. They drift slowly, so a fast change means that the cameras
// contradict the IMU: most features are on a dynamic object, which the biases come to explain.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <optional>

#include "edged/core/odom_state.hpp"
#include "edged/estimator/initialization/initialization_solver.hpp"
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
  /// As they were 10 s ago, or first, and as they are; nothing before any was added.
  std::optional<BiasPrior> oldest() const {
    return entries_.empty() ? std::nullopt : std::optional(prior(entries_.front()));
  }
  std::optional<BiasPrior> newest() const {
    return entries_.empty() ? std::nullopt : std::optional(prior(entries_.back()));
  }

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  struct Entry {
    Timestamp t;
    Vector6d bias;      ///< gyro [rad/s], then accelerometer [m/s^2]
    Vector6d variance;  ///< at that time
  };

  static BiasPrior prior(const Entry& entry);

  ImuNoise noise_;
  std::deque<Entry> entries_;
};

}  // namespace edged

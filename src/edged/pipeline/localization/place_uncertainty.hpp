// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How well the place in the map is known after gaps of all sensors and losses, until the body is relocalized.
#pragma once

#include <algorithm>
#include <cmath>

#include "edged/imu/preintegration.hpp"
#include "edged/state.hpp"

namespace edged {

/// Sigmas of the worst axis. Drift while the estimate goes on is none of it: the map bounds that.
class PlaceUncertainty {
 public:
  /// What dead reckoning begins with.
  struct DeadReckoning {
    double position = 0.0;  ///< beyond that of the estimate [m]
    double velocity = 0.0;  ///< [m/s]
    double tilt = 0.0;      ///< a share of gravity is taken for acceleration [rad]
    double yaw = 0.0;       ///< [rad]
  };

  /// The estimate goes on after a gap.
  void end_gap() { after_gap_ = true; }
  /// position_sigma: of the newest estimate, since its start [m]; enough: the place counts as known.
  void update(double position_sigma, double enough) {
    if (after_gap_ && position_sigma - position_sigma_ > enough) {
      by_gap_ = position_sigma - position_sigma_;
      return;
    }
    position_sigma_ = position_sigma;
    after_gap_ = false;
    by_gap_ = 0.0;
  }
  /// The estimate has ended.
  void end_estimate(const DeadReckoning& begin) {
    position_ = std::hypot(std::hypot(position_, begin.position), position_sigma_, by_gap_);
    yaw_ = std::hypot(yaw_, begin.yaw);
    ended_ = true;
    velocity_ = begin.velocity;
    acceleration_ = kGravity * begin.tilt;
    position_sigma_ = by_gap_ = 0.0;
    after_gap_ = false;
  }
  /// Without an estimate. Before the first one there is no place to be uncertain of.
  void dead_reckon(const Preintegration& motion) {
    if (!ended_) return;
    const auto variances = motion.covariance().diagonal();
    position_ = std::hypot(position_ + velocity_ * motion.dt(), std::sqrt(variances.segment<3>(6).maxCoeff()));
    velocity_ = std::hypot(velocity_ + acceleration_ * motion.dt(), std::sqrt(variances.segment<3>(3).maxCoeff()));
    yaw_ = std::hypot(yaw_, std::sqrt(variances.head<3>().maxCoeff()));
  }
  void relocalize() { *this = PlaceUncertainty(); }

  /// By losses: of the start of the present estimate.
  double position() const { return position_; }                    ///< [m]
  double yaw() const { return yaw_; }                              ///< [rad]
  double doubt() const { return std::hypot(position_, by_gap_); }  ///< by losses and a gap of the present estimate [m]

 private:
  double position_sigma_ = 0.0;  ///< of the estimate, before a gap
  bool after_gap_ = false, ended_ = false;
  double by_gap_ = 0.0, position_ = 0.0, yaw_ = 0.0;
  double velocity_ = 0.0, acceleration_ = 0.0;
};

}  // namespace edged

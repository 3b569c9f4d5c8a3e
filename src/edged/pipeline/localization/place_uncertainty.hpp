// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// How well the position in the map is known after gaps of all sensors and losses, until the body is relocalized.
#pragma once

#include <algorithm>
#include <cmath>

#include "edged/imu/preintegration.hpp"

namespace edged {

/// Sigmas of the worst axis. Drift while the estimate goes on is none of it: the map bounds that.
class PlaceUncertainty {
 public:
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
  /// The estimate has ended. velocity_sigma: of dead reckoning, which begins [m/s].
  void end_estimate(double velocity_sigma) {
    by_losses_ = std::hypot(sigma(), position_sigma_);
    velocity_sigma_ = velocity_sigma;
    position_sigma_ = by_gap_ = 0.0;
    after_gap_ = false;
  }
  /// Without an estimate.
  void dead_reckon(const Preintegration& motion) {
    const auto variances = motion.covariance().diagonal();
    by_losses_ = std::hypot(by_losses_ + velocity_sigma_ * motion.dt(), std::sqrt(variances.segment<3>(6).maxCoeff()));
    velocity_sigma_ = std::hypot(velocity_sigma_, std::sqrt(variances.segment<3>(3).maxCoeff()));
  }
  void relocalize() { by_losses_ = by_gap_ = 0.0, after_gap_ = false; }

  double sigma() const { return std::hypot(by_losses_, by_gap_); }  ///< [m]

 private:
  double position_sigma_ = 0.0;  ///< of the estimate, before a gap
  bool after_gap_ = false;
  double by_gap_ = 0.0, by_losses_ = 0.0;
  double velocity_sigma_ = 0.0;
};

}  // namespace edged

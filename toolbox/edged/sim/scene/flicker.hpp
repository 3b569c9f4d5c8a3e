// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Lamps whose light follows the mains or a PWM.
#pragma once

#include <Eigen/Core>

#include "edged/se3.hpp"
#include "edged/sim/simulator_config.hpp"

namespace edged {

/// The flicker at one instant.
struct FlickerNow {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< place of the one lamp that flickers
  float deviation = 0.0F;                            ///< its light over its mean, minus one
  float reach = 0.0F;                                ///< [m]; 0: all lamps flicker together

  /// On the light at p, in the frame of the centre. The share of the lamp in it is a half at its reach.
  float factor(const Eigen::Vector3f& p) const {
    if (reach == 0.0F) return 1.0F + deviation;
    const float squared = reach * reach;
    return 1.0F + deviation * squared / (squared + (p - centre).squaredNorm());
  }
};

class Flicker {
 public:
  /// disturbance: its begin, end and modulation, (max - min) / (max + min) of the light. centre_W: of the one lamp, if
  /// config has a reach.
  Flicker(const FlickerConfig& config, const Disturbance& disturbance, const Eigen::Vector3d& centre_W)
      : config_(config), disturbance_(disturbance), centre_W_(centre_W) {}

  FlickerNow at(double t_s, const SE3& T_C_W) const;
  /// The next instant at which a picture is needed so that the light is linear in between; without flicker, a later
  /// one.
  double next_knot_s(double t_s) const;

 private:
  double wave(double cycles) const;

  FlickerConfig config_;
  Disturbance disturbance_;
  Eigen::Vector3d centre_W_;
};

}  // namespace edged

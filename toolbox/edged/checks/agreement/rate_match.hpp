// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Finds any offset between the clocks of a camera and a gyro by the correlation of their turn rates.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "edged/checks/agreement/visual_turns.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// Turn rates on an even grid [rad/s]; not finite where they are unknown.
struct RateSeries {
  static constexpr Duration kStep = std::chrono::milliseconds(20);
  Timestamp begin;
  std::vector<Eigen::Vector3d> rates;
};

/// The turn rates of a camera in the axes of the body; the turns are in time order.
RateSeries camera_rates(std::span<const Turn> turns, const Eigen::Matrix3d& R_B_C);
/// The means of the gyro over `window`, the usual length of the turns that they are compared with.
RateSeries gyro_rates(std::span<const ImuSample> samples, Duration window);
/// Their size instead of the axes, for a camera whose rotation to the body is unknown.
void use_speeds(RateSeries& series);

/// The best offset, and the best one beside it.
struct RateMatch {
  Duration shift{0};              ///< t_gyro = t_camera + shift, to a part of the step
  double correlation = 0.0;       ///< of the changes of the rates there
  double next_correlation = 0.0;  ///< of the best offset beside that peak
  Duration next_shift{0};
  Duration overlap{0};  ///< time with rates of both
  bool unique = false;  ///< the first is a far better one than any other
};

/// Tries all offsets at which the two overlap for long enough. Nothing where there is none with turn rates that change.
std::optional<RateMatch> match_rates(const RateSeries& camera, const RateSeries& gyro);

}  // namespace edged

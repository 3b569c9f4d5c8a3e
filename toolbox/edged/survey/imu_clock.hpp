// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Rate of the IMU's clock relative to that of a camera.
#pragma once

#include <optional>
#include <span>

#include "edged/survey/gyro_integral.hpp"
#include "edged/survey/visual_turns.hpp"

namespace edged {

/// A clock that runs at another rate than the camera's.
struct ClockRate {
  double rate = 1.0;         ///< seconds of the IMU to a second of the camera
  double correlation = 0.0;  ///< of how fast both turn, the clock corrected
};

/// Compares how fast camera and gyro turn, whatever the camera's mounting and the gyro's unit, with the stamps of the
/// IMU stretched about its first one. Nothing if the rate is right or cannot be determined.
/// expected: t_imu = t_cam + it. spans: how long the IMU lasts over how long the cameras do, which is tried, too.
std::optional<ClockRate> other_clock_rate(std::span<const Turn> turns, const GyroIntegral& gyro, Duration expected,
                                          double spans);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The rate of the IMU clock relative to the clock of a camera.
#pragma once

#include <optional>
#include <span>

#include "edged/checks/agreement/gyro_integral.hpp"
#include "edged/checks/agreement/visual_turns.hpp"

namespace edged {

/// The rate of an IMU clock that differs from that of the camera.
struct ClockRate {
  double rate = 1.0;         ///< seconds of the IMU per second of the camera
  double correlation = 0.0;  ///< between the angular speeds of both, with the corrected clock
};

/// Compares the angular speeds of camera and gyro, independent of the mounting of the camera and the unit of the gyro,
/// with the stamps of the IMU scaled about the first one. Nothing if the rate is correct or cannot be determined.
/// expected: t_imu = t_cam + expected. spans: duration of the IMU over that of the cameras, a candidate of the rate.
std::optional<ClockRate> other_clock_rate(std::span<const Turn> turns, const GyroIntegral& gyro, Duration expected,
                                          double spans);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Checks whether changes of the direction of travel of a camera agree with the accelerometer.
#pragma once

#include <cstddef>
#include <span>

#include "edged/checks/agreement/ray_fit.hpp"

namespace edged {

/// With fewer turns, the result is undetermined.
inline constexpr std::size_t kFewestAccelTurns = 24;

struct AccelAgreement {
  std::size_t turns = 0;     ///< compared
  double correlation = 0.0;  ///< between camera and accelerometer: positive if they agree, negative for a wrong sign
};

/// The velocity of the camera changes by the specific force minus gravity. So at any scale, the part of its next
/// displacement perpendicular to the present one points along that force. Gravity is the mean over some seconds. It has
/// the sign of the accelerometer, so a negated accelerometer gives the opposite direction.
AccelAgreement compare_with_accel(std::span<const Turn> turns, const GyroIntegral& imu, const GyroMount& mount);

}  // namespace edged

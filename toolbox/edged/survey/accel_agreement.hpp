// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether the change of a camera's direction of travel agrees with the accelerometer.
#pragma once

#include <cstddef>
#include <span>

#include "edged/survey/ray_fit.hpp"

namespace edged {

/// With fewer the result is undetermined.
inline constexpr std::size_t kFewestAccelTurns = 24;

struct AccelAgreement {
  std::size_t turns = 0;     ///< compared
  double correlation = 0.0;  ///< of the two: above 0 where they agree, below with a wrong sign
};

/// The camera keeps its velocity except for the specific force beyond gravity: at any scale, the part of its next
/// displacement across the present one points along that force. Gravity is the mean over some seconds, which has the
/// accelerometer's own sign, so a negated accelerometer points the other way.
AccelAgreement compare_with_accel(std::span<const Turn> turns, const GyroIntegral& imu, const GyroMount& mount);

}  // namespace edged

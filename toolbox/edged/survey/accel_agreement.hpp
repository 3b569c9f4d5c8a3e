// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether a camera changes its way to where the accelerometer says it is pushed.
#pragma once

#include <cstddef>
#include <span>

#include "edged/survey/ray_fit.hpp"

namespace edged {

/// Fewer tell nothing.
inline constexpr std::size_t kFewestAccelTurns = 24;

struct AccelAgreement {
  std::size_t turns = 0;     ///< compared
  double correlation = 0.0;  ///< of the two: above 0 where they agree, below where its sign is the wrong one
};

/// The camera goes on along its way but for what the specific force beyond gravity adds: whatever the scale of the
/// view, the part of its next way that is across the present one points to where it is pushed. Gravity is the mean of
/// some seconds, which has the accelerometer's own sign, so that a negated one pushes the other way.
AccelAgreement compare_with_accel(std::span<const Turn> turns, const GyroIntegral& imu, const GyroMount& mount);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Degrees for input and output; all computations are in radians.
#pragma once

#include <numbers>

namespace edged {

inline constexpr double kDegree = std::numbers::pi / 180.0;  ///< [rad]
inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Degrees, as users give and read them; all inside is in radians.
#pragma once

#include <numbers>

namespace edged {

inline constexpr double kDegree = std::numbers::pi / 180.0;  ///< [rad]
inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

}  // namespace edged

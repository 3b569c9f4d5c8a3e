// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Units of files and options that are not SI; all computations are in SI units.
#pragma once

#include <numbers>

namespace edged {

inline constexpr double kDegree = std::numbers::pi / 180.0;  ///< [rad]
inline constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;
inline constexpr double kStandardGravity = 9.80665;  ///< [m/s^2]: the unit g of accelerometers

}  // namespace edged

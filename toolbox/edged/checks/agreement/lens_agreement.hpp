// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether a camera turns like the gyro if seen through another lens than the calibrated one.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "edged/checks/agreement/gyro_agreement.hpp"

namespace edged {

/// What the lens would be, where that explains the turns of frames far better than the calibration, which leaves
/// `unexplained`.
std::optional<std::string> better_lens(const RigCamera& camera, std::span<const Turn> turns, const GyroIntegral& gyro,
                                       double unexplained);

}  // namespace edged

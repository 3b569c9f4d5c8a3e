// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether the rows of a camera's images are read one after the other: a rolling shutter.
#pragma once

#include <optional>
#include <span>

#include "edged/checks/agreement/gyro_agreement.hpp"
#include "edged/rig.hpp"

namespace edged {

/// The instant of the last row minus that of the first: 0 with a global shutter [s].
struct Readout {
  double s = 0.0, sigma_s = 0.0;
};

/// A rolling shutter bends the rays of a turn as no rotation and translation does; the gyro tells how far for a second
/// of readout. agreement: that of the same turns. Nothing with too few corners.
std::optional<Readout> readout_of(std::span<const Turn> turns, const GyroIntegral& gyro, const CameraModel& camera,
                                  const GyroAgreement& agreement);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which sensors a run uses, and which cameras of the calibration those are.
#pragma once

#include <string>

#include "edged/pipeline/packetizer.hpp"
#include "source.hpp"

namespace edged {

/// "events", "frames" or "fused".
std::string mode_name(Mode mode);

/// The mode asked for, or for "auto" the most that the recording holds. Throws InputError where it lacks a sensor.
Mode choose_mode(const std::string& wanted, const DatasetInfo& info);

/// Calls the cameras that the mode needs as the recording does, and warns of what it had to assume for that. Throws
/// InputError where it cannot be known.
void match_cameras(Source& source, Mode mode);

}  // namespace edged

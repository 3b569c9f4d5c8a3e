// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Modes by name, and the one that fits a recording.
#pragma once

#include <string>

#include "edged/core/dataset.hpp"
#include "edged/pipeline/packetizer.hpp"

namespace edged {

/// "events", "frames" or "fused".
std::string mode_name(Mode mode);

/// The mode of that name. Throws InputError that lists them.
Mode parse_mode(const std::string& name);

/// The mode asked for, or for "auto" the most that the recording holds. Throws InputError where it lacks a sensor.
Mode choose_mode(const std::string& wanted, const DatasetInfo& info);

}  // namespace edged

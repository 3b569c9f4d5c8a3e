// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Checks a well-formed calibration for impossible and implausible values. Internal to io.
#pragma once

#include <string>
#include <vector>

#include "edged/io/archive/source_path.hpp"
#include "edged/io/sensor_head.hpp"

namespace edged {

/// One line with the remedy for each implausible value: lever arms (long, or millimetres instead of metres), fields of
/// view, principal points, image sizes. Throws InputError for a field of view that no lens has.
std::vector<std::string> implausibilities(const Calibration& calibration, const SourcePath& path);

}  // namespace edged

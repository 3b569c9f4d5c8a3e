// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What cannot be, or hardly, in a calibration that is well-formed. Internal to io.
#pragma once

#include <string>
#include <vector>

#include "edged/io/sensor_head.hpp"
#include "edged/io/source_path.hpp"

namespace edged {

/// One line for all that looks wrong, with the remedy: lever arms (long; metres that were millimetres), fields of view,
/// principal points, image sizes. Throws InputError for a field of view that no lens has.
std::vector<std::string> implausibilities(const Calibration& calibration, const SourcePath& path);

}  // namespace edged

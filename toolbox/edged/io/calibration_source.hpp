// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Loads calibrations, also from files in an archive.
#pragma once

#include "edged/io/sensor_head.hpp"
#include "edged/io/source_path.hpp"

namespace edged {

Calibration read_calibration(const SourcePath& path, const CalibrationOptions& options = {});

}  // namespace edged

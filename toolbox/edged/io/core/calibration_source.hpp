// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Loads calibrations, also from files in an archive.
#pragma once

#include "edged/io/archive/source_path.hpp"
#include "edged/io/calibration_data.hpp"

namespace edged {

Calibration read_calibration(const SourcePath& path, const CalibrationOptions& options = {});

}  // namespace edged

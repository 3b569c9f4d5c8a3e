// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Findings of checks, and calibrations as estimated, as text and json.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "edged/checks/calibration_fit.hpp"
#include "edged/checks/finding.hpp"

namespace edged {

/// A line for each finding and one for its remedy, errors last, and a summary.
std::string to_text(const std::vector<Finding>& findings);
nlohmann::ordered_json to_json(const std::vector<Finding>& findings);
nlohmann::ordered_json to_json(const CalibrationFound& found);

std::string to_text(const CalibrationFit& fit);
nlohmann::ordered_json to_json(const CalibrationFit& fit);

bool has_error(const std::vector<Finding>& findings);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Surveys and diagnoses as text and json.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "edged/survey/diagnosis.hpp"

namespace edged {

std::string to_text(const Survey& survey);
nlohmann::ordered_json to_json(const Survey& survey);

/// A line for each finding and one for its remedy, errors last, and a summary.
std::string to_text(const std::vector<Finding>& findings);
nlohmann::ordered_json to_json(const std::vector<Finding>& findings);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// An evaluation as json and as a table.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "edged/eval/consistency.hpp"
#include "edged/eval/metrics.hpp"

namespace edged {

nlohmann::ordered_json to_json(const Evaluation& evaluation);
nlohmann::ordered_json to_json(const Consistency& consistency);
std::string to_table(const Evaluation& evaluation);
/// In one line, of the windows that there are.
std::string local_error_text(const std::vector<LocalError>& local);

}  // namespace edged

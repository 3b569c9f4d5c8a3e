// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What report.html shows, as json: read from run folders and trajectory files.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "report/evaluation.hpp"

namespace edged {

struct ReportOptions {
  std::filesystem::path truth;  ///< of the sensor whose poses the trajectory files hold; "": what each run knew
  EvaluationOptions how;
};

/// runs: folders that `edged run` left, and trajectory files to hold against them. A table of at most some 3000 rows
/// and 60 pictures in all, however long they are. Throws InputError for what is neither.
nlohmann::ordered_json report_data(const std::vector<std::filesystem::path>& runs, const ReportOptions& options = {});

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The data of report.html as json, from run folders and trajectory files.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "report/evaluation.hpp"

namespace edged {

struct ReportOptions {
  std::filesystem::path truth;  ///< of the sensor of the trajectory files; "": that of each run
  EvaluationOptions how;
};

/// runs: folders of `edged run`, and trajectory files to compare with them. A table of at most some 3000 rows, 60
/// pictures, 1,000,000 dense points and 250,000 voxels in all, however long they are. Throws InputError for anything
/// else.
nlohmann::ordered_json report_data(const std::vector<std::filesystem::path>& runs, const ReportOptions& options = {});

}  // namespace edged

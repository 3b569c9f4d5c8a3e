// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged calib --refine`: one calibration from what runs over several recordings found.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/source.hpp"

namespace edged {

struct CalibRefineOptions {
  std::vector<std::string> recordings;
  SourceOptions source;  ///< how to read each of them
  std::string mode = "auto";
  std::filesystem::path out;  ///< for the calibration
  bool quiet = false, json = false;
};

/// Runs over each recording from the same calibration, prints what they found together, and writes it. Returns the exit
/// code: 4 where no recording gave an estimate.
int refine_calibration(const CalibRefineOptions& options);

}  // namespace edged

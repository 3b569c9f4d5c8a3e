// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Several recordings in one call of `edged run`: each is run by a process of its own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/cli_fwd.hpp"

namespace edged {

struct ManyRuns {
  std::vector<std::string> recordings;
  std::vector<std::string> arguments;  ///< of `edged run`, for each of them
  std::filesystem::path out;           ///< folder for their run folders; "": each finds its own
  bool force = false, quiet = false, json = false;
  int jobs = 1;  ///< processes at once
};

/// The arguments of `edged run` common to all its recordings, without the output.
std::vector<std::string> arguments_for_each(const CLI::App& run, const std::vector<std::string>& assignments);

/// Prints the summary table, or with json {"runs": [...]}, in the order of the recordings. Returns the exit code of the
/// first that is not 0; or that of a signal.
int run_many(const ManyRuns& runs);

}  // namespace edged

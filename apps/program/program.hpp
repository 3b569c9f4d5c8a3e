// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The version, and the common part of every main: parses the command line, and turns exceptions into one line and an
// exit code.
#pragma once

#include <algorithm>
#include <functional>
#include <string>

#include "common/cli_fwd.hpp"

namespace edged {

/// Version of the project and state of the source tree at build time, e.g. "0.1.0 (1a2b3c4, changed)".
extern const char* const kVersion;

/// Parses the command line, calls run, and returns the exit code (commands.hpp). run: may be chosen by the command
/// line.
int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& run);

/// Largest number of edits for a word to count as mistyped.
inline std::size_t typing_errors(const std::string& word) { return std::max<std::size_t>(2, word.size() / 4); }

/// "" without a similar one.
inline std::string did_you_mean(const std::string& nearest) {
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What every main does: reads the command line, and turns exceptions into one line and an exit code.
#pragma once

#include <functional>

#include "cli_fwd.hpp"

namespace edged {

/// Parses the command line, calls run, and returns the exit code (exit_code.hpp). run: may be chosen by the command
/// line.
int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& run);

}  // namespace edged

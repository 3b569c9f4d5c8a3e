// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The common part of every main: parses the command line, and turns exceptions into one line and an
// exit code.
#pragma once

#include <functional>

#include "common/cli.hpp"

namespace edged {

/// Parses the command line, calls run, and returns the exit code (common/cli.hpp). run: may be chosen by the command
/// line.
int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& run);

}  // namespace edged

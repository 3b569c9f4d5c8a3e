// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The options --export and --export-hz of `edged run`.
#pragma once

#include "common/cli_fwd.hpp"
#include "run/run_options.hpp"

namespace edged {

void add_export_options(CLI::App& app, ExportOptions& options);

}  // namespace edged

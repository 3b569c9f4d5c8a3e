// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged config`: every option with its unit, range, default and effect.
#pragma once

#include <functional>

#include "cli_fwd.hpp"

namespace edged {

/// Adds the sub-command; `chosen` receives what to run when the user chose it.
void add_config_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace edged

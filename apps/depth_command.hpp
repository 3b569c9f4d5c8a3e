// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged depth`: what a depth network is, what it costs here, and where others come from.
#pragma once

#include <functional>

#include "cli_fwd.hpp"

namespace edged {

/// Adds the sub-command; `chosen` receives what to run when the user chose it.
void add_depth_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace edged

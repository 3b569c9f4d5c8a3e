// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged manual`, hidden: the man page and the completion of bash, both from the command line as it is declared.
#pragma once

#include <functional>

#include "cli_fwd.hpp"

namespace edged {

/// To be added last: describes the sub-commands that app has by the time it runs.
void add_manual_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace edged

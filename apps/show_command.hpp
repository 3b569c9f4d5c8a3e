// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged show`.
#pragma once

#include <functional>

#include "cli_fwd.hpp"

namespace edged {

void add_show_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace edged

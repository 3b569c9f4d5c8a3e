// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged map`: what is in a map, its points as a file, two made one.
#pragma once

#include <functional>

#include "cli_fwd.hpp"

namespace edged {

void add_map_command(CLI::App& app, std::function<int()>& chosen);

}  // namespace edged

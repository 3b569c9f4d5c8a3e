// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Saved maps: --map and --save-map of `edged run`.
#pragma once

#include <filesystem>
#include <string>

#include "common/cli_fwd.hpp"
#include "edged/map/saved_map.hpp"
#include "run/run_options.hpp"

namespace edged {

/// Adds --map and --save-map.
void add_map_options(CLI::App& app, MapOptions& options);

/// Throws InputError, with the file's name.
SavedMap read_map(const std::filesystem::path& file);

}  // namespace edged

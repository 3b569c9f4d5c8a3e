// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Saved maps, as `edged run --save-map` writes them.
#pragma once

#include <filesystem>
#include <string>

#include "edged/map/saved_map.hpp"

namespace edged {

/// The first line of each.
std::string beginning_of_maps();

/// Throws InputError, with the file's name.
SavedMap read_map(const std::filesystem::path& file);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Files of maps, as --save-map writes them.
#pragma once

#include <filesystem>
#include <string>

#include "edged/map/saved_map.hpp"

namespace edged {

/// Both throw InputError, with the file's name.
std::string read_map_bytes(const std::filesystem::path& file);
SavedMap read_map(const std::filesystem::path& file);

/// Before what a long run has seen can then not be kept: throws InputError where the file's folder does not exist.
void check_folder_of(const std::filesystem::path& file);

}  // namespace edged

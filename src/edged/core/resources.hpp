// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Files that come with the program and are read when it runs: calibrations of known rigs, networks.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace edged {

/// The folders there are of one kind ("rigs", "depth"), best first: the one that the environment names (EDGED_RIGS,
/// EDGED_DEPTH), share/edged/KIND beside the folder of the running program, and that of the installation that the
/// library was built for.
std::vector<std::filesystem::path> resource_folders(std::string_view kind);

/// The files there with this extension (".yaml"), by name; of two of a name the better folder's.
std::vector<std::filesystem::path> resources(std::string_view kind, std::string_view extension);

/// The file of that name without its extension, if there is one.
std::optional<std::filesystem::path> find_resource(std::string_view kind, const std::string& name,
                                                   std::string_view extension);

}  // namespace edged

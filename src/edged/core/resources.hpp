// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Files that come with the program and are read when it runs: calibrations of known rigs, networks, presets of the
// simulator.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace edged {

/// The existing folders of one kind ("rigs", "depth", "presets"), best first: the one that the environment names
/// (EDGED_RIGS, EDGED_DEPTH, EDGED_PRESETS), share/edged/KIND beside the folder of the running program,
/// share/edged/KIND in the folder of the shared library (a wheel of Python), and that of the installation that the
/// library was built for.
std::vector<std::filesystem::path> resource_folders(std::string_view kind);

/// The files with this extension (".yaml") in these folders, by name; of equal names that of the better folder.
std::vector<std::filesystem::path> resources(std::string_view kind, std::string_view extension);

/// The file with that name (without extension), if any.
std::optional<std::filesystem::path> find_resource(std::string_view kind, const std::string& name,
                                                   std::string_view extension);

}  // namespace edged

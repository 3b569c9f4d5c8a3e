// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The run folder as one file, for sending: --archive of `edged run`.
#pragma once

#include <filesystem>
#include <string>

#include "cli_fwd.hpp"
#include "run_folder.hpp"

namespace edged {

inline constexpr const char* kArchiveBeside = "true";  ///< --archive without a file: FOLDER.zip

void add_archive_option(CLI::App& app, std::string& archive);

/// Throws InputError where the file is there already and is to be kept, or could not be written in the end.
void check_archive(const std::filesystem::path& file, EarlierRun earlier);

}  // namespace edged

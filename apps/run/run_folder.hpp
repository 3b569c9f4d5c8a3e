// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The folder a run leaves behind, and the file that it may be packed into.
#pragma once

#include <filesystem>
#include <string>

#include "common/cli_fwd.hpp"

namespace edged {

/// What becomes of an earlier run in the folder that is asked for.
enum class EarlierRun { Keep, Replace };

/// Makes the folder and returns it. Where it holds an earlier run, that run's files are replaced, or it is kept and the
/// folder gets a number: FOLDER-2, FOLDER-3, the first that is free. Runs that begin at once never get the same. Throws
/// InputError when the path is something else: a file, or a folder that holds things but no run.
std::filesystem::path make_run_folder(const std::filesystem::path& wanted, EarlierRun earlier = EarlierRun::Keep);

/// Of a run that does not begin: takes its mark away, and the folder where nothing else is in it.
void give_back_run_folder(const std::filesystem::path& folder);

/// FOLDER with the suffix behind its name, also where it is written as FOLDER/ or `.`
std::filesystem::path beside(const std::filesystem::path& folder, const std::string& suffix);

inline constexpr const char* kArchiveBeside = "true";  ///< --archive without a file: FOLDER.zip

void add_archive_option(CLI::App& app, std::string& archive);

/// Throws InputError where the file is there already and is to be kept, or could not be written in the end.
void check_archive(const std::filesystem::path& file, EarlierRun earlier);

}  // namespace edged

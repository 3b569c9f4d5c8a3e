// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The output folder of a run, and its archive.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/cli.hpp"

namespace edged {

/// What to do with an earlier run in the chosen folder.
enum class EarlierRun { Keep, Replace };

/// Makes the folder and returns it. Where it holds an earlier run, that run's files are replaced, or it is kept and the
/// folder gets a number: FOLDER-2, FOLDER-3, the first that is free. files: those that a run may have left there.
/// Concurrent runs never get one folder. Throws InputError when the path is something else: a file, or a folder that
/// holds things but no run.
std::filesystem::path make_run_folder(const std::filesystem::path& wanted, EarlierRun earlier = EarlierRun::Keep,
                                      const std::vector<const char*>& files = {});

/// For a run that does not begin: removes its mark, and the folder if it is then empty.
void remove_new_run_folder(const std::filesystem::path& folder);

/// FOLDER with the suffix behind its name, also where it is written as FOLDER/ or `.`
std::filesystem::path beside(const std::filesystem::path& folder, const std::string& suffix);

inline constexpr const char* kArchiveBeside = "true";  ///< --archive without a file: FOLDER.zip

void add_archive_option(CLI::App& app, std::string& archive);

/// Throws InputError if the file exists and must be kept, or cannot be written.
void check_archive(const std::filesystem::path& file, EarlierRun earlier);

}  // namespace edged

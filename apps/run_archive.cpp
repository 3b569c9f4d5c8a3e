// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run_archive.hpp"

#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cstdlib>

#include "edged/core/check.hpp"

namespace edged {

void add_archive_option(CLI::App& app, std::string& archive) {
  app.add_flag("--archive", archive,
               "Pack the run folder into one file at the end, however the run ends; --archive=FILE [FOLDER.zip]");
}

void check_archive(const std::filesystem::path& file, EarlierRun earlier) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw InputError::format("{}: is a folder; give a file, --archive=FILE.zip", file.string());
  if (earlier == EarlierRun::Keep && std::filesystem::exists(file, error))
    throw InputError::format("{}: is there already; give another --archive=FILE, or --force to replace it",
                             file.string());
  // What cannot be written is told before the run, not after it.
  std::string trial = file.string() + ".XXXXXX";
  const int opened = mkstemp(trial.data());
  if (opened < 0)
    throw InputError::format(
        "{}: cannot be written; give --archive=FILE in a folder that is there and may be written to", file.string());
  close(opened);
  std::filesystem::remove(trial, error);
}

}  // namespace edged

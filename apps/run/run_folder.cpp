// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_folder.hpp"

#include <unistd.h>
#include <CLI/CLI.hpp>
#include <system_error>

#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include "common/files.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr const char* kMark = "config_resolved.yaml";  // written before anything else, marks a folder as a run's

[[noreturn]] void refuse_folder(const std::filesystem::path& folder, const std::error_code& error) {
  throw InputError::format("{}: cannot be used as a run folder: {}; give another --out", folder.string(),
                           error.message());
}

/// Whether it does not exist, is empty, or is of an earlier run. Throws InputError if that is unknown.
bool may_hold_a_run(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (!fs::status_known(status)) refuse_folder(folder, error);
  if (!fs::exists(status)) return true;
  if (!fs::is_directory(status))
    throw InputError::format("{}: is a file, not a folder; give another --out", folder.string());
  const bool empty = fs::is_empty(folder, error);
  if (error) refuse_folder(folder, error);
  return empty || fs::exists(folder / kMark);
}

/// Removes these files of an earlier run.
void remove_files(const std::filesystem::path& folder, const std::vector<const char*>& files) {
  for (const char* name : files) {
    for (const std::filesystem::path& file : {folder / name, part_of(folder / name)}) {
      std::error_code error;
      std::filesystem::remove(file, error);
      if (error) throw InputError::format("{}: cannot be replaced: {}", file.string(), error.message());
    }
  }
}

/// Makes the folder and its mark. False: an earlier run's mark is there.
bool claim(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) refuse_folder(folder, error);
  std::FILE* mark = std::fopen((folder / kMark).c_str(), "wx");  // only one of several concurrent runs succeeds
  if (mark != nullptr) return std::fclose(mark), true;
  if (errno != EEXIST) refuse_folder(folder, {errno, std::generic_category()});
  return false;
}

}  // namespace

std::filesystem::path beside(const std::filesystem::path& folder, const std::string& suffix) {
  std::filesystem::path plain = folder.lexically_normal();
  if (!plain.has_filename()) plain = plain.parent_path();
  if (plain.empty() || plain.filename() == "." || plain.filename() == "..")
    plain = std::filesystem::weakly_canonical(folder);
  return plain += suffix;
}

std::filesystem::path make_run_folder(const std::filesystem::path& wanted, EarlierRun earlier,
                                      const std::vector<const char*>& files) {
  if (!may_hold_a_run(wanted))
    throw InputError::format("{}: holds files, but no earlier run; give another --out", wanted.string());
  std::filesystem::path folder = wanted;
  if (earlier == EarlierRun::Replace) {
    remove_files(folder, files);
    claim(folder);
    return folder;
  }
  for (int number = 2; !may_hold_a_run(folder) || !claim(folder); ++number)
    folder = beside(wanted, fmt::format("-{}", number));
  return folder;
}

void remove_new_run_folder(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::remove(folder / kMark, ignored);
  std::filesystem::remove(folder, ignored);  // fails where it is not empty
}

void add_archive_option(CLI::App& app, std::string& archive) {
  app.add_flag("--archive", archive,
               "Also pack the run folder into one file, however the run ends; --archive=FILE [FOLDER.zip]");
}

void check_archive(const std::filesystem::path& file, EarlierRun earlier) {
  std::error_code error;
  if (earlier == EarlierRun::Keep && std::filesystem::is_regular_file(file, error))
    throw InputError::format("{}: exists already; give another --archive=FILE, or --force to replace it",
                             file.string());
  check_writable(file, "--archive");
}

}  // namespace edged

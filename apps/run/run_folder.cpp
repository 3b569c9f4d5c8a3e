// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run/run_folder.hpp"

#include <unistd.h>
#include <CLI/CLI.hpp>
#include <system_error>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include "common/files.hpp"
#include "edged/core/check.hpp"

namespace edged {
namespace {

// The first is written before anything else and marks a folder as a run's.
constexpr std::array kRunFiles = {"config_resolved.yaml",
                                  "calibration.yaml",
                                  "trajectory.tum",
                                  "trajectory_euroc.csv",
                                  "trajectory.kitti",
                                  "states.csv",
                                  "metrics.json",
                                  "timing.json",
                                  "overview.png",
                                  "run.log",
                                  "album.json",
                                  "groundtruth.tum",
                                  "calibration_found.yaml",
                                  "report.html",
                                  "trajectory_final.tum",
                                  "keyframes.csv",
                                  "map.ply",
                                  "dense.ply",
                                  "voxels.ply",
                                  "pace.csv",
                                  "results.mcap",
                                  "external.csv"};

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
  return empty || fs::exists(folder / kRunFiles[0]);
}

/// All files but its mark.
void empty_of_run(const std::filesystem::path& folder) {
  for (const char* name : kRunFiles) {
    if (name == kRunFiles[0]) continue;
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
  std::FILE* mark = std::fopen((folder / kRunFiles[0]).c_str(), "wx");  // only one of several concurrent runs succeeds
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

std::filesystem::path make_run_folder(const std::filesystem::path& wanted, EarlierRun earlier) {
  if (!may_hold_a_run(wanted))
    throw InputError::format("{}: holds files, but no earlier run; give another --out", wanted.string());
  std::filesystem::path folder = wanted;
  if (earlier == EarlierRun::Replace) {
    empty_of_run(folder);
    claim(folder);
    return folder;
  }
  for (int number = 2; !may_hold_a_run(folder) || !claim(folder); ++number)
    folder = beside(wanted, fmt::format("-{}", number));
  return folder;
}

void give_back_run_folder(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::remove(folder / kRunFiles[0], ignored);
  std::filesystem::remove(folder, ignored);  // fails where it is not empty
}

void add_archive_option(CLI::App& app, std::string& archive) {
  app.add_flag("--archive", archive,
               "Also pack the run folder into one file, however the run ends; --archive=FILE [FOLDER.zip]");
}

void check_archive(const std::filesystem::path& file, EarlierRun earlier) {
  std::error_code error;
  if (earlier == EarlierRun::Keep && std::filesystem::is_regular_file(file, error))
    throw InputError::format("{}: is there already; give another --archive=FILE, or --force to replace it",
                             file.string());
  check_writable(file, "--archive");
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/files.hpp"

#include <unistd.h>
#include <system_error>

#include <cerrno>
#include <cstdlib>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/io/parse/image_codec.hpp"

namespace edged {
namespace {

std::string reason() { return std::generic_category().message(errno); }

std::ofstream open_for_writing(const std::filesystem::path& file) {
  std::ofstream out(file);
  if (!out) throw InputError::format("{}: cannot be written: {}", file.string(), reason());
  return out;
}

}  // namespace

TableFile::TableFile(std::filesystem::path file, const std::string& heading)
    : file_(std::move(file)), out_(open_for_writing(file_)) {
  add(heading);  // a run without a line leaves a readable table, too
}

void TableFile::add(const std::string& line) {
  if (!(out_ << line).flush()) throw InputError::format("{}: cannot be written; is the disk full?", file_.string());
}

void check_writable(const std::filesystem::path& file, const char* option, std::string_view kind_begins) {
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored) && !std::filesystem::is_regular_file(file, ignored))
    throw InputError::format("{}: is a folder, a pipe or a device; give {} a file", file.string(), option);
  if (begins_otherwise(file, kind_begins))
    throw InputError::format("{}: exists, and is not a file that {} replaces; choose another name, or remove it",
                             file.string(), option);
  std::string trial = file.string() + ".XXXXXX";
  const int opened = mkstemp(trial.data());
  if (opened < 0)
    throw InputError::format("{}: cannot be written: {}; give {} a file in an existing folder that you may write to",
                             file.string(), reason(), option);
  close(opened);
  std::filesystem::remove(trial, ignored);
}

void check_empty(const std::filesystem::path& folder, const char* option) {
  std::error_code ignored;
  if (std::filesystem::exists(folder, ignored) && !std::filesystem::is_empty(folder, ignored))
    throw InputError::format("{} {}: exists already and is not empty; choose another, or add --force", option,
                             folder.string());
}

void make_picture_folder(const std::filesystem::path& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed)
    throw InputError::format("{}: cannot make this folder ({}); choose another --out", folder.string(),
                             failed.message());
}

void write_picture(const std::filesystem::path& file, const cv::Mat& image) {
  const Bytes bytes = file.extension() == ".pgm" ? encode_pgm(image) : encode_png(image);
  write_file(file, std::string(as_text(bytes)));
}

}  // namespace edged

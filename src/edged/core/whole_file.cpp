// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/core/whole_file.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>

#include "edged/core/check.hpp"

namespace edged {

std::optional<std::string> read_file(const std::filesystem::path& file) {
  std::error_code ignored;
  std::ifstream in;
  if (std::filesystem::is_regular_file(file, ignored)) in.open(file, std::ios::binary);
  if (!in.is_open()) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

bool begins_otherwise(const std::filesystem::path& file, std::string_view kind_begins) {
  std::string begin(kind_begins.size(), '\0');
  std::ifstream before(file, std::ios::binary);
  return before.read(begin.data(), std::ssize(begin)).gcount() > 0 && begin != kind_begins;
}

std::filesystem::path part_of(std::filesystem::path file) { return file += ".part"; }

void write_file(const std::filesystem::path& file, const std::string& content) {
  const std::filesystem::path part = part_of(file);
  std::ofstream out(part);
  if (!out)
    throw InputError::format("{}: cannot be written: {}", part.string(), std::generic_category().message(errno));
  out << content;
  if (!out.flush()) {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);  // frees the space for other files
    throw InputError::format("{}: cannot be written; is the disk full?", file.string());
  }
  std::error_code failed, ignored;
  std::filesystem::rename(part, file, failed);
  if (!failed) return;
  std::filesystem::remove(part, ignored);
  throw std::filesystem::filesystem_error("rename", part, file, failed);
}

}  // namespace edged

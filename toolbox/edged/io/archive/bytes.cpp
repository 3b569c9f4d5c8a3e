// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/archive/bytes.hpp"

#include <algorithm>

#include "edged/core/check.hpp"

namespace edged {

void require_regular_file(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_other(file, ignored))
    throw InputError::format("{}: is not a file but a pipe or a device: write its data to a file first", file.string());
}

void refuse_shortened_file(const std::string& name) {
  throw InputError::format("{}: was truncated while it was read, or its disk fails: copy it again", name);
}

BinaryFile::BinaryFile(const std::filesystem::path& file) : name_(file.string()) {
  require_regular_file(file);
  file_.open(file, std::ios::binary | std::ios::ate);
  if (!file_) throw InputError::format("{}: cannot be opened for reading", name_);
  size_ = static_cast<std::uint64_t>(file_.tellg());
}

Bytes BinaryFile::read(std::uint64_t offset, std::size_t count) {
  if (offset >= size_) return {};
  Bytes bytes(static_cast<std::size_t>(std::min<std::uint64_t>(count, size_ - offset)));
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(offset));
  file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(file_.gcount()) < bytes.size()) refuse_shortened_file(name_);
  return bytes;
}

OutputFile::OutputFile(const std::filesystem::path& file) : name_(file.string()), file_(file, std::ios::binary) {
  check();
}

void OutputFile::write(std::string_view bytes) {
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  size_ += bytes.size();
  check();
}

void OutputFile::overwrite(std::uint64_t offset, std::string_view bytes) {
  file_.seekp(static_cast<std::streamoff>(offset));
  file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file_.seekp(0, std::ios::end);
  check();
}

void OutputFile::flush() {
  file_.flush();
  check();
}

void OutputFile::check() const {
  if (!file_) throw InputError::format("{}: cannot be written: is the folder there, the disk full?", name_);
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Zip archives as folders of files. Internal to SourcePath.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "edged/io/archive/bytes.hpp"

struct zip;

namespace edged {

/// The bytes that a text of so many compressed ones may have: what unpacks to more is made to take time. Numbers of
/// sensors are compressed to a fifth.
constexpr std::uint64_t most_unpacked(std::uint64_t packed) { return (std::uint64_t{16} << 20U) + 100 * packed; }

/// Not thread-safe.
class ZipArchive {
 public:
  /// Reads the list of files. Throws InputError if it is damaged.
  explicit ZipArchive(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  bool is_file(const std::filesystem::path& path) const;
  bool is_folder(const std::filesystem::path& path) const;
  std::vector<std::string> names(const std::filesystem::path& folder) const;
  /// The source may outlive this object. Throws InputError.
  std::unique_ptr<ByteSource> open(const std::filesystem::path& path);

 private:
  std::filesystem::path file_;
  std::shared_ptr<zip> zip_;
  std::map<std::string, std::uint64_t> entries_;  ///< path of each file to its index
};

/// head: the first bytes of a file.
bool is_zip(ByteSpan head);

/// Writes all files of the folder and its subfolders, under its name, except `file` itself. Replaces `file` atomically,
/// after all is written. Throws InputError if a file cannot be read or the archive cannot be written.
void zip_folder(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace edged

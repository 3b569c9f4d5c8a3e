// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The files of a recording, wherever they lie: in a folder or in a zip archive, which is read in place; gzip
// files as what they hold.
#pragma once

#include <concepts>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "edged/io/byte_source.hpp"
#include "edged/io/bytes.hpp"

namespace edged {

class ZipArchive;

/// A file or a folder, on disk or within an archive. Behaves as a path does.
class SourcePath {
 public:
  /// On disk. Implicit, as every path on disk is the path of a source.
  template <typename Path>
  requires std::convertible_to<Path, std::filesystem::path> SourcePath(const Path& path)  // NOLINT
      : path_(path) {}

  /// The folder that an archive is, packed. Throws InputError when it cannot be opened.
  static SourcePath in_archive(const std::filesystem::path& zip);

  SourcePath operator/(const std::filesystem::path& below) const { return {path_ / below, archive_}; }
  SourcePath parent_path() const;

  /// Nothing within an archive.
  std::optional<std::filesystem::path> disk_path() const { return archive_ ? std::nullopt : std::optional(path_); }
  /// In an archive or a gzip file: it can be read from its begin only.
  bool is_packed() const;
  bool is_file() const;
  bool is_folder() const;
  /// Names of what a folder holds, sorted.
  std::vector<std::string> names() const;

  /// For messages: "flight.zip/events.txt" within an archive.
  std::string string() const;
  /// Its last name; of the top of an archive the archive's without ".zip".
  std::string name() const;

  /// Throws InputError when it cannot be opened.
  std::unique_ptr<ByteSource> open() const;
  /// So many bytes of its front, or all there are before its end or damage.
  Bytes head(std::size_t most) const;
  /// All of it. Throws as open and read do, and Damage beyond max_bytes.
  Bytes read(std::size_t max_bytes) const;

 private:
  SourcePath(std::filesystem::path path, std::shared_ptr<ZipArchive> archive)
      : path_(std::move(path)), archive_(std::move(archive)) {}

  std::filesystem::path path_;           ///< within the archive, if there is one
  std::shared_ptr<ZipArchive> archive_;  ///< null: on disk
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Paths of the files of a recording: in a folder or in a zip archive, which is read in place. Gzip files are read as
// their content.
#pragma once

#include <concepts>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "edged/io/archive/bytes.hpp"

namespace edged {

class ZipArchive;

/// A file or a folder, on disk or within an archive. Used like std::filesystem::path.
class SourcePath {
 public:
  /// A path on disk. Implicit, as each path on disk is a SourcePath.
  template <typename Path>
  requires std::convertible_to<Path, std::filesystem::path> SourcePath(const Path& path)  // NOLINT
      : path_(path) {}

  /// The root folder of an archive. Throws InputError if the archive cannot be opened.
  static SourcePath in_archive(const std::filesystem::path& zip);

  SourcePath operator/(const std::filesystem::path& below) const { return {path_ / below, archive_}; }
  SourcePath parent_path() const;

  /// Nothing within an archive.
  std::optional<std::filesystem::path> disk_path() const { return archive_ ? std::nullopt : std::optional(path_); }
  /// True in an archive or for a gzip file, which can only be read sequentially.
  bool is_packed() const;
  bool is_file() const;  ///< refuses pipes and devices by an InputError
  bool is_folder() const;
  /// Names of the entries of a folder, sorted.
  std::vector<std::string> names() const;

  /// For messages: "flight.zip/events.txt" within an archive.
  std::string string() const;
  /// The last component. For the root of an archive, the name of the archive without ".zip".
  std::string name() const;

  /// Throws InputError when it cannot be opened.
  std::unique_ptr<ByteSource> open() const;
  /// The first `most` bytes, or fewer before the end or damage.
  Bytes head(std::size_t most) const;
  /// The whole content. Throws as open() does, and Damage for a damaged file or one beyond max_bytes.
  Bytes read(std::size_t max_bytes) const;

 private:
  SourcePath(std::filesystem::path path, std::shared_ptr<ZipArchive> archive)
      : path_(std::move(path)), archive_(std::move(archive)) {}

  std::filesystem::path path_;           ///< within the archive, if there is one
  std::shared_ptr<ZipArchive> archive_;  ///< null: on disk
};

/// head: the first bytes of a file.
bool is_zip(ByteSpan head);

/// Writes all files of the folder and its subfolders, under its name, except `file` itself. Replaces `file` atomically,
/// after all is written. Throws InputError if a file cannot be read or the archive cannot be written.
void zip_folder(const std::filesystem::path& file, const std::filesystem::path& folder);

}  // namespace edged

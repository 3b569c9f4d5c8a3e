// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/archive/zip_writer.hpp"

#include <zip.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "edged/core/check.hpp"
#include "edged/io/archive/zip_archive.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse_zip(const fs::path& file, const std::string& reason) {
  throw InputError::format("{}: cannot be written: {}", file.string(), reason);
}

/// Sorted by name, so that the same files give the same archive.
std::vector<fs::path> files_below(const fs::path& folder, const fs::path& but) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && !(fs::exists(but) && fs::equivalent(entry.path(), but)))
      files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

}  // namespace

void zip_folder(const fs::path& file, const fs::path& folder) {
  const std::vector<fs::path> files = files_below(folder, file);
  int error = 0;
  zip_t* opened = zip_open(file.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error);
  if (!opened) refuse_zip(file, zip_reason(error));
  std::unique_ptr<zip_t, decltype(&zip_discard)> archive(opened, zip_discard);
  const fs::path whole = fs::canonical(folder);
  for (const fs::path& from : files) {
    const std::string name = (whole.filename() / from.lexically_relative(folder)).generic_string();
    zip_source_t* source = zip_source_file(archive.get(), from.c_str(), 0, -1);
    if (!source || zip_file_add(archive.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8) < 0) {
      zip_source_free(source);
      refuse_zip(file, zip_strerror(archive.get()));
    }
  }
  if (zip_close(archive.get()) != 0) refuse_zip(file, zip_strerror(archive.get()));
  archive.release();
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads zip archives by libzip, as ByteSource.
#include "edged/io/archive/zip_archive.hpp"

#include <zip.h>

#include <algorithm>

#include "edged/core/check.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

/// The normalized name of an entry: generic separators, no leading "./".
std::string entry_name(const fs::path& path) {
  std::string name = path.lexically_normal().generic_string();
  return name == "." ? "" : name;
}

/// "" for the root, else with a separator at the end.
std::string folder_prefix(const fs::path& folder) {
  std::string name = entry_name(folder);
  if (!name.empty() && name.back() != '/') name += '/';
  return name;
}

class ZipSource final : public ByteSource {
 public:
  ZipSource(std::shared_ptr<zip> archive, zip_file_t* file, std::uint64_t most)
      : archive_(std::move(archive)), file_(file), left_(most) {}

  std::size_t read(std::span<char> to) override {
    const zip_int64_t got = zip_fread(file_.get(), to.data(), to.size());
    if (got < 0) throw Damage(fmt::format("the archive is damaged here ({})", zip_file_strerror(file_.get())));
    if (static_cast<std::uint64_t>(got) > left_) throw Damage("unpacks to far more than sensors write");
    left_ -= static_cast<std::uint64_t>(got);
    return static_cast<std::size_t>(got);
  }

 private:
  struct Close {
    void operator()(zip_file_t* f) const { zip_fclose(f); }
  };

  std::shared_ptr<zip> archive_;
  std::unique_ptr<zip_file_t, Close> file_;
  std::uint64_t left_;  ///< bytes that may follow
};

/// The text of libzip for the number of an error.
std::string zip_reason(int error) {
  zip_error_t text;
  zip_error_init_with_code(&text, error);
  const std::string reason = zip_error_strerror(&text);
  zip_error_fini(&text);
  return reason;
}

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

ZipArchive::ZipArchive(const fs::path& file) : file_(file) {
  int error = 0;
  zip_t* archive = zip_open(file.c_str(), ZIP_RDONLY, &error);
  if (!archive)
    throw InputError::format(
        "{}: cannot be read as a zip archive ({}): is it complete? Unpack it, or repair it (zip -FF)", file.string(),
        zip_reason(error));
  zip_.reset(archive, zip_discard);
  const zip_int64_t count = zip_get_num_entries(archive, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const auto number = static_cast<std::uint64_t>(i);
    const char* raw = zip_get_name(archive, number, ZIP_FL_ENC_GUESS);
    if (!raw) continue;
    std::string name = raw;
    std::replace(name.begin(), name.end(), '\\', '/');
    if (!name.empty() && name.back() != '/') entries_.emplace(entry_name(name), number);
  }
}

bool ZipArchive::is_file(const fs::path& path) const { return entries_.contains(entry_name(path)); }

bool ZipArchive::is_folder(const fs::path& path) const {
  const std::string prefix = folder_prefix(path);
  const auto first = entries_.lower_bound(prefix);
  return first != entries_.end() && first->first.starts_with(prefix);
}

std::vector<std::string> ZipArchive::names(const fs::path& folder) const {
  const std::string prefix = folder_prefix(folder);
  std::vector<std::string> names;
  for (auto entry = entries_.lower_bound(prefix); entry != entries_.end() && entry->first.starts_with(prefix);
       ++entry) {
    std::string name = entry->first.substr(prefix.size());
    name.resize(std::min(name.size(), name.find('/')));
    if (names.empty() || names.back() != name) names.push_back(std::move(name));
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::unique_ptr<ByteSource> ZipArchive::open(const fs::path& path) {
  const auto refuse = [&](const char* reason) {
    return InputError::format("{}: cannot be opened: {}", (file_ / path).string(), reason);
  };
  const auto entry = entries_.find(entry_name(path));
  if (entry == entries_.end()) throw refuse("the archive has no such file");
  zip_file_t* opened = zip_fopen_index(zip_.get(), entry->second, 0);
  if (!opened) throw refuse(zip_strerror(zip_.get()));
  return std::make_unique<ZipSource>(zip_, opened, most_unpacked(fs::file_size(file_)));
}

bool is_zip(ByteSpan head) {
  return as_text(head).starts_with("PK\x03\x04") || as_text(head).starts_with("PK\x05\x06");
}

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

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens files on disk, and files of zip archives by libzip.
#include "edged/io/archive/source_path.hpp"

#include <zip.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <map>
#include <set>

#include "edged/core/check.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

/// The bytes that a text of so many compressed ones may have: what unpacks to more is made to take time. Numbers of
/// sensors are compressed to a fifth.
constexpr std::uint64_t most_unpacked(std::uint64_t packed) { return (std::uint64_t{16} << 20U) + 100 * packed; }

bool is_gzip(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return false;
  constexpr std::string_view kMagic = "\x1f\x8b";
  char head[2] = {};
  std::ifstream in(file, std::ios::binary);
  return in.read(head, sizeof head) && std::string_view(head, sizeof head) == kMagic;
}

/// A file on disk. A gzip file, of one part or several, gives its content.
class DiskSource final : public ByteSource {
 public:
  explicit DiskSource(const fs::path& file)
      : name_(file.string()), file_(gzopen(name_.c_str(), "rb")), packed_(is_gzip(file)) {
    if (!file_) throw InputError::format("{}: cannot be opened: {}", name_, std::strerror(errno));
    std::error_code failed;
    const std::uintmax_t size = fs::file_size(file, failed);
    if (!failed) left_ = packed_ ? most_unpacked(size) : size;
  }

  std::size_t read(std::span<char> to) override {
    const int got = gzread(file_.get(), to.data(), static_cast<unsigned>(to.size()));
    if (got <= 0) refuse_error();
    const auto bytes = static_cast<std::uintmax_t>(got);
    if (packed_ && bytes > left_) throw Damage("unpacks to far more than sensors write");
    if (!packed_ && bytes == 0 && !to.empty() && left_ > 0) refuse_shortened_file(name_);
    left_ -= std::min(bytes, left_);
    return bytes;
  }

 private:
  /// Nothing at the end of the file.
  void refuse_error() const {
    int error = Z_OK;
    const std::string text = gzerror(file_.get(), &error);
    if (error == Z_ERRNO) throw InputError::format("{}: cannot be read: {}", name_, std::strerror(errno));
    if (error != Z_OK) throw Damage("damaged or cut: " + text);
  }

  struct Close {
    void operator()(gzFile_s* f) const { gzclose(f); }
  };

  std::string name_;
  std::unique_ptr<gzFile_s, Close> file_;
  bool packed_;
  std::uintmax_t left_ = 0;  ///< bytes that may follow: of a file that is not packed, those it had when it was opened
};

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

/// A zip archive as folders of files. Not thread-safe.
class ZipArchive {
 public:
  /// Reads the list of files. Throws InputError if it is damaged.
  explicit ZipArchive(const fs::path& file) : file_(file) {
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

  const fs::path& file() const { return file_; }
  bool is_file(const fs::path& path) const { return entries_.contains(entry_name(path)); }

  bool is_folder(const fs::path& path) const {
    const std::string prefix = folder_prefix(path);
    const auto first = entries_.lower_bound(prefix);
    return first != entries_.end() && first->first.starts_with(prefix);
  }

  std::vector<std::string> names(const fs::path& folder) const {
    const std::string prefix = folder_prefix(folder);
    std::set<std::string> names;
    for (auto entry = entries_.lower_bound(prefix); entry != entries_.end() && entry->first.starts_with(prefix);
         ++entry)
      names.insert(entry->first.substr(prefix.size(), entry->first.find('/', prefix.size()) - prefix.size()));
    return {names.begin(), names.end()};
  }

  /// The source may outlive this object. Throws InputError.
  std::unique_ptr<ByteSource> open(const fs::path& path) {
    const auto refuse = [&](const char* reason) {
      return InputError::format("{}: cannot be opened: {}", (file_ / path).string(), reason);
    };
    const auto entry = entries_.find(entry_name(path));
    if (entry == entries_.end()) throw refuse("the archive has no such file");
    zip_file_t* opened = zip_fopen_index(zip_.get(), entry->second, 0);
    if (!opened) throw refuse(zip_strerror(zip_.get()));
    return std::make_unique<ZipSource>(zip_, opened, most_unpacked(fs::file_size(file_)));
  }

 private:
  fs::path file_;
  std::shared_ptr<zip_t> zip_;
  std::map<std::string, std::uint64_t> entries_;  ///< path of each file to its index
};

SourcePath SourcePath::in_archive(const fs::path& zip) { return {fs::path(), std::make_shared<ZipArchive>(zip)}; }

SourcePath SourcePath::parent_path() const {
  return {(archive_ ? path_ : fs::absolute(path_)).parent_path(), archive_};
}

bool SourcePath::is_packed() const { return archive_ || is_gzip(path_); }

bool SourcePath::is_file() const {
  if (archive_) return archive_->is_file(path_);
  require_regular_file(path_);
  std::error_code ignored;
  return fs::is_regular_file(path_, ignored);
}

bool SourcePath::is_folder() const {
  std::error_code ignored;
  return archive_ ? archive_->is_folder(path_) : fs::is_directory(path_, ignored);
}

std::vector<std::string> SourcePath::names() const {
  if (archive_) return archive_->names(path_);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(path_)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string SourcePath::string() const {
  if (!archive_) return path_.string();
  return path_.empty() ? archive_->file().string() : (archive_->file() / path_).string();
}

std::string SourcePath::name() const {
  if (archive_) return path_.empty() ? archive_->file().stem().string() : path_.filename().string();
  return fs::absolute(path_ / ".").parent_path().filename().string();  // also for "."
}

std::unique_ptr<ByteSource> SourcePath::open() const {
  if (archive_) return archive_->open(path_);
  require_regular_file(path_);
  return std::make_unique<DiskSource>(path_);
}

Bytes SourcePath::head(std::size_t most) const {
  const std::unique_ptr<ByteSource> source = open();
  Bytes bytes(most);
  std::size_t filled = 0;
  try {
    while (const std::size_t got = source->read({reinterpret_cast<char*>(bytes.data()) + filled, most - filled}))
      filled += got;
  } catch (const Damage&) {
    // The bytes before the damage are used as a short file.
  }
  bytes.resize(filled);
  return bytes;
}

Bytes SourcePath::read(std::size_t max_bytes) const {
  constexpr std::size_t kFirstStep = 1 << 16;
  const std::unique_ptr<ByteSource> source = open();
  Bytes bytes(kFirstStep);
  std::size_t filled = 0;
  while (const std::size_t got =
             source->read({reinterpret_cast<char*>(bytes.data()) + filled, bytes.size() - filled})) {
    filled += got;
    if (filled > max_bytes) throw Damage("is larger than any such file should be");
    if (filled == bytes.size()) bytes.resize(2 * filled);
  }
  bytes.resize(filled);
  return bytes;
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

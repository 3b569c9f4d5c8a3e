// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens files on disk, and files of archives by ZipArchive.
#include "edged/io/archive/source_path.hpp"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <fstream>

#include "edged/core/check.hpp"
#include "edged/io/archive/zip_archive.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

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

}  // namespace

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

}  // namespace edged

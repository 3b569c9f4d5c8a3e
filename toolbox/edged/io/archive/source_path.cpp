// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens files on disk, and files of archives by ZipArchive.
#include "edged/io/archive/source_path.hpp"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <fstream>

#include "edged/core/check.hpp"
#include "edged/io/archive/zip_archive.hpp"

namespace edged {
namespace fs = std::filesystem;
namespace {

class DiskSource final : public ByteSource {
 public:
  explicit DiskSource(const fs::path& file) : name_(file.string()), file_(std::fopen(name_.c_str(), "rb")) {
    if (!file_) throw InputError::format("{}: cannot be opened: {}", name_, std::strerror(errno));
    std::setvbuf(file_.get(), nullptr, _IONBF, 0);
    std::error_code failed;
    if (const std::uintmax_t size = fs::file_size(file, failed); !failed) left_ = size;
  }

  std::size_t read(std::span<char> to) override {
    const std::size_t got = std::fread(to.data(), 1, to.size(), file_.get());
    if (std::ferror(file_.get())) throw InputError::format("{}: cannot be read: {}", name_, std::strerror(errno));
    if (got == 0 && !to.empty() && left_ > 0) refuse_shortened_file(name_);
    left_ -= std::min<std::uintmax_t>(got, left_);
    return got;
  }

 private:
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };

  std::string name_;
  std::unique_ptr<std::FILE, Close> file_;
  std::uintmax_t left_ = 0;  ///< bytes up to the end that the file had when it was opened
};

/// A gzip file, of one part or several.
class GzipSource final : public ByteSource {
 public:
  explicit GzipSource(const fs::path& file) : name_(file.string()), file_(gzopen(name_.c_str(), "rb")) {
    if (!file_) throw InputError::format("{}: cannot be opened: {}", name_, std::strerror(errno));
    left_ = most_unpacked(fs::file_size(file));
  }

  std::size_t read(std::span<char> to) override {
    const int got = gzread(file_.get(), to.data(), static_cast<unsigned>(to.size()));
    if (got > 0 && static_cast<std::uint64_t>(got) > left_) throw Damage("unpacks to far more than sensors write");
    if (got > 0) left_ -= static_cast<std::uint64_t>(got);
    if (got > 0 || (got == 0 && ended_well())) return static_cast<std::size_t>(got);
    int error = Z_OK;
    const std::string text = gzerror(file_.get(), &error);
    if (error == Z_ERRNO) throw InputError::format("{}: cannot be read: {}", name_, std::strerror(errno));
    throw Damage("damaged or cut: " + text);
  }

 private:
  /// True if the file ends without an error.
  bool ended_well() const {
    int error = Z_OK;
    gzerror(file_.get(), &error);
    return error == Z_OK;
  }

  struct Close {
    void operator()(gzFile_s* f) const { gzclose(f); }
  };

  std::string name_;
  std::unique_ptr<gzFile_s, Close> file_;
  std::uint64_t left_ = 0;  ///< bytes that may follow
};

bool is_gzip(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return false;
  constexpr std::string_view kMagic = "\x1f\x8b";
  char head[2] = {};
  std::ifstream in(file, std::ios::binary);
  return in.read(head, sizeof head) && std::string_view(head, sizeof head) == kMagic;
}

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
  if (is_gzip(path_)) return std::make_unique<GzipSource>(path_);
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

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Decompresses messages in memory, and files on disk.
#include "edged/io/ros/bag/unpacked_source.hpp"

#include <unistd.h>

#include "edged/core/check.hpp"
#include "edged/io/archive/compression.hpp"

namespace edged {
namespace {

constexpr std::size_t kLargestMessage = 1U << 28U;

/// A temporary folder, which the destructor removes with its content.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "edged_XXXXXX").string();
    if (!::mkdtemp(pattern.data()))
      throw InputError::format("{}: cannot be made, to unpack a bag there: set TMPDIR", pattern);
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace

std::optional<Message> UnpackedSource::unpack(const std::function<std::optional<Message>()>& next) {
  while (const auto message = next()) {
    if (!as_text(message->data).starts_with(kZstdMagic)) return message;
    Decompressed unpacked = decompress("zstd", message->data, kLargestMessage);
    message_ = std::move(unpacked.bytes);
    if (unpacked.whole) return Message{message->topic, message_};
    if (repairs_) repairs_->add("bag: message damaged", name_ + ": a compressed message is not whole");
  }
  return std::nullopt;
}

std::unique_ptr<MessageSource> open_packed_messages(
    const std::filesystem::path& path,
    const std::function<std::unique_ptr<MessageSource>(const std::filesystem::path& unpacked)>& open,
    Repairs* repairs) {
  const ScratchFolder scratch;
  const std::filesystem::path unpacked = scratch.path() / path.stem();
  if (!decompress_zstd_file(path, unpacked) && repairs)
    repairs->add("bag: cut", path.string() + ": the compressed file is not whole");
  return open(unpacked);
}

}  // namespace edged

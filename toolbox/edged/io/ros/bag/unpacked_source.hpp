// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// ROS 2 bags with messages or whole files compressed by zstd.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "edged/io/parse/repairs.hpp"
#include "edged/io/ros/bag/message_source.hpp"

namespace edged {

/// The first bytes of zstd data. No message in CDR begins so.
inline constexpr std::string_view kZstdMagic = "\x28\xB5\x2F\xFD";

/// The messages of another source. Messages that are compressed one by one are decompressed.
class UnpackedSource final : public MessageSource {
 public:
  UnpackedSource(std::unique_ptr<MessageSource> packed, std::string name, Repairs* repairs)
      : packed_(std::move(packed)), name_(std::move(name)), repairs_(repairs) {}

  Wire wire() const override { return packed_->wire(); }
  const std::vector<Topic>& topics() const override { return packed_->topics(); }
  Duration length() const override { return packed_->length(); }
  std::optional<Message> next() override {
    return unpack([this] { return packed_->next(); });
  }
  std::optional<Message> next_of(std::size_t topic) override {
    return unpack([this, topic] { return packed_->next_of(topic); });
  }

 private:
  /// The next message that can be decompressed.
  std::optional<Message> unpack(const std::function<std::optional<Message>()>& next);

  std::unique_ptr<MessageSource> packed_;
  std::string name_;
  Repairs* repairs_;
  Bytes message_;
};

/// Opens a bag that is compressed as a whole. Decompresses it into a file in the folder of temporary files (TMPDIR),
/// which `open` opens. The file is then unlinked, so it disappears with the source.
std::unique_ptr<MessageSource> open_packed_messages(
    const std::filesystem::path& path,
    const std::function<std::unique_ptr<MessageSource>(const std::filesystem::path& unpacked)>& open, Repairs* repairs);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// MCAP files with ROS 2 messages.
#pragma once

#include <map>

#include "edged/io/ros/message_source.hpp"

namespace edged {

/// Records of an opcode and a length, most in chunks, which may be compressed. The summary at the end tells topics and
/// counts; without one (an unfinished file) all is read through once.
class Mcap final : public MessageSource {
 public:
  /// Throws InputError when there is nothing to read.
  Mcap(const std::filesystem::path& file, Repairs* repairs);

  Wire wire() const override { return wire_; }
  const std::vector<Topic>& topics() const override { return topics_; }
  Duration length() const override { return last_ > first_ ? last_ - first_ : Duration(0); }
  std::optional<Message> next() override;

 private:
  bool read_summary();
  void read_through();
  bool load_next_record();
  std::optional<Message> take_message();
  bool take_description(std::uint8_t op, ByteReader& record);
  void rewind();
  void repair(const std::string& kind, const std::string& detail);

  std::string name_;
  BinaryFile file_;
  Repairs* repairs_;
  Wire wire_ = Wire::Cdr;
  std::vector<Topic> topics_;
  std::map<std::uint16_t, std::string> schemas_;  ///< types of messages
  std::map<std::uint16_t, std::size_t> topic_of_channel_;
  Timestamp first_ = Timestamp::max(), last_ = Timestamp::min();
  std::uint64_t at_ = 0;  ///< next record of the file
  Bytes records_;         ///< those of the chunk being read
  ByteReader reader_{ByteSpan()};
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The messages of MCAP files: those of ROS. Other topics are listed by name only.
#pragma once

#include <map>

#include "edged/io/ros/bag/record_source.hpp"

namespace edged {

/// A record is an opcode, a length and its content.
class Mcap final : public RecordSource {
 public:
  /// Throws InputError for a file without messages.
  Mcap(const std::filesystem::path& path, Repairs* repairs);

  Wire wire() const override { return wire_; }

 private:
  void read_index() override;
  void forget() override;
  bool load_record() override;
  std::optional<Message> take_message() override;
  void load_chunk(ByteReader chunk);
  bool take_description(std::uint8_t op, ByteReader& record);
  void take_statistics(ByteReader& record);
  void take_chunk_index(ByteReader& record);

  Wire wire_ = Wire::Cdr;
  struct Schema {
    std::string type, definition;
  };
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::size_t> topic_of_channel_;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes ROS 1 bags of version 2.0, without ROS.
#pragma once

#include <map>
#include <vector>

#include "edged/io/archive/compression.hpp"
#include "edged/io/ros/bag/message_sink.hpp"

namespace edged {

/// Chunks are compressed by "none" or "lz4".
class BagWriter final : public MessageSink {
 public:
  explicit BagWriter(const std::filesystem::path& file, const ChunkOptions& options = {.compression = "lz4"});

  Wire wire() const override { return Wire::Ros1; }
  std::size_t add_topic(std::string_view name, std::string_view type, const MessageDefinition& definition) override;
  void write(std::size_t topic, Timestamp t, std::string_view message) override;
  void finish() override;

 private:
  struct IndexEntry {
    Timestamp t;
    std::uint32_t offset;  ///< of the message among the chunk's records
  };
  struct ChunkInfo {
    std::uint64_t place;
    Timestamp begin, end;
    std::map<std::uint32_t, std::uint32_t> counts;  ///< messages by connection
  };
  struct Connection {
    std::string record;
    bool written = false;  ///< its record is in a chunk
  };

  void write_head(std::uint64_t index_place);
  void close_chunk();

  OutputFile file_;
  ChunkOptions options_;
  std::vector<Connection> connections_;
  std::vector<ChunkInfo> chunks_;
  std::string chunk_;                                       ///< records of the one being filled
  std::map<std::uint32_t, std::vector<IndexEntry>> index_;  ///< of that chunk, by connection
};

}  // namespace edged

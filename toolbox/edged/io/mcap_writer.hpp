// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes MCAP files with ROS 2 messages.
#pragma once

#include <map>
#include <vector>

#include "edged/io/ros/message_sink.hpp"

namespace edged {

/// Chunks are compressed by "", "lz4" or "zstd".
class McapWriter final : public MessageSink {
 public:
  explicit McapWriter(const std::filesystem::path& file, const ChunkOptions& options = {.compression = "zstd"});

  Wire wire() const override { return Wire::Cdr; }
  std::size_t add_topic(std::string_view name, std::string_view type, const MessageDefinition& definition) override;
  void write(std::size_t topic, Timestamp t, std::string_view message) override;
  void finish() override;

 private:
  struct Channel {
    std::string schema, channel;  ///< records
    bool written = false;         ///< they are in a chunk
    std::uint64_t messages = 0;
  };
  struct IndexEntry {
    std::uint64_t t, offset;  ///< of the message among the chunk's records
  };
  struct ChunkInfo {
    std::uint64_t begin, end, place, bytes;  ///< [ns], [ns], of the record in the file
    std::map<std::uint16_t, std::uint64_t> index_places;
    std::uint64_t index_bytes, packed, unpacked;
  };

  void close_chunk();
  ChunkInfo write_chunk();
  std::string statistics() const;
  std::string chunk_index(const ChunkInfo& chunk) const;

  OutputFile file_;
  ChunkOptions options_;
  std::vector<Channel> channels_;
  std::vector<ChunkInfo> chunks_;
  std::string chunk_;                                       ///< records of the one being filled
  std::map<std::uint16_t, std::vector<IndexEntry>> index_;  ///< of that chunk, by channel
};

}  // namespace edged

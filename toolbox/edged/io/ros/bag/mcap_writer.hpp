// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes MCAP files with messages of any type.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/archive/compression.hpp"
#include "edged/time.hpp"

namespace edged {

/// The type of the messages of a topic.
struct McapTopic {
  std::string_view name, encoding;                  ///< "/tf", "json"
  std::string_view type, type_encoding, type_text;  ///< "foxglove.FrameTransform", "jsonschema", the schema
};

/// Holds one chunk and the index in memory; chunks are compressed by "", "lz4" or "zstd". An unfinished
/// file is readable as far as it was written. All members throw InputError if the file cannot be written.
class McapWriter {
 public:
  /// profile: "ros2", or "" for none.
  McapWriter(const std::filesystem::path& file, std::string_view profile, const ChunkOptions& options = {"zstd"});

  /// Adds a topic and returns its number, for write().
  std::size_t add_topic(const McapTopic& topic);
  /// t: the time of recording and of publication. Negative times become zero.
  void write(std::size_t topic, Timestamp t, std::string_view message);
  void write_metadata(std::string_view name, const std::map<std::string, std::string>& values);
  /// Call before and after messages whose times differ from their neighbours: readers find messages by the times of
  /// their chunk.
  void close_chunk();
  /// Completes the file with its index. Nothing may be written afterwards.
  void finish();

 private:
  struct Channel {
    std::string schema, channel;  ///< records
    bool written = false;         ///< the records are in a chunk
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

  ChunkInfo write_chunk();
  std::string statistics() const;
  std::string chunk_index(const ChunkInfo& chunk) const;

  OutputFile file_;
  ChunkOptions options_;
  std::vector<Channel> channels_;
  std::vector<ChunkInfo> chunks_;
  std::vector<std::string> metadata_index_;                 ///< records
  std::string chunk_;                                       ///< records of the one being filled
  std::map<std::uint16_t, std::vector<IndexEntry>> index_;  ///< of that chunk, by channel
};

}  // namespace edged

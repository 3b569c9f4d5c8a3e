// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes MCAP files with messages of any type.
#pragma once

#include <map>

#include "edged/io/ros/bag/message_records.hpp"

namespace edged {

/// The type of the messages of a topic.
struct McapTopic {
  std::string_view name, encoding;                  ///< "/tf", "json"
  std::string_view type, type_encoding, type_text;  ///< "foxglove.FrameTransform", "jsonschema", the schema
};

/// Chunks are compressed by "", "lz4" or "zstd". Negative times become zero.
class McapWriter final : public RecordWriter {
 public:
  /// profile: "ros2", or "" for none.
  McapWriter(const std::filesystem::path& file, std::string_view profile, const ChunkOptions& options = {"zstd"});

  Wire wire() const override { return Wire::Cdr; }
  /// A topic of ROS 2.
  std::size_t add_topic(std::string_view name, std::string_view type, const MessageDefinition& definition) override;
  /// A topic of any type.
  std::size_t add_topic(const McapTopic& topic);
  void write_metadata(std::string_view name, const std::map<std::string, std::string>& values);

 private:
  std::string message_record(std::size_t topic, Timestamp t, std::string_view message) const override;
  std::string chunk_record(const ChunkInfo& chunk, std::string_view packed) const override;
  std::string index_record(std::size_t topic, const std::vector<IndexEntry>& entries) const override;
  void write_summary() override;
  std::string statistics() const;
  std::string chunk_index(const ChunkInfo& chunk) const;

  std::vector<std::string> metadata_index_;  ///< records
};

}  // namespace edged

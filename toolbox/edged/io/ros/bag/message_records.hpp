// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The messages in the records of ROS 1 bags and MCAP files, reading and writing: of MCAP files with messages of any
// type.
#pragma once

#include <map>

#include "edged/io/archive/record_file.hpp"
#include "edged/io/ros/bag/open_messages.hpp"

namespace edged {

/// Reads a file of records, most of them in chunks that may be compressed. An index at the end holds topics and counts.
/// If it is missing or damaged, as after a crash of the recorder, the whole file is read once.
class RecordSource : public MessageSource, protected RecordFile {
 public:
  const std::vector<Topic>& topics() const final { return topics_; }
  Duration length() const final { return last_ > first_ ? last_ - first_ : Duration(0); }
  std::optional<Timestamp> begin_stamp() const final { return last_ >= first_ ? std::optional(first_) : std::nullopt; }
  std::optional<Message> read(std::optional<std::size_t> only) final;

 protected:
  static constexpr std::uint64_t kLargestRecord = 1U << 28U;  ///< longer ones are damage; chunks of 768 kB are usual
  enum Kind : std::uint32_t { kSkipped, kPlain, kChunk };     ///< kPlain: read by take_record()

  /// first_record: its offset, after the magic bytes.
  RecordSource(const BagFile& file, std::uint64_t first_record, Repairs* repairs)
      : RecordFile(BinaryFile(file.path), first_record), name_(file.name), repairs_(repairs) {}

  /// Reads topics, counts and times. To be called last in a constructor. Throws InputError without messages.
  void find_topics();

  // The description of a format, beside locate(). Each function may throw Damage.

  /// Reads the records of the index by take_index(), which describe topics, counts and chunks.
  virtual void read_index() = 0;
  /// Discards the descriptions from the records so far.
  virtual void forget() = 0;
  /// Takes the next record, of any kind. Nothing if it is no message.
  virtual std::optional<Message> take_record(ByteReader& records) = 0;
  struct PackedChunk {
    std::string_view compression;
    std::uint64_t bytes;     ///< uncompressed
    ByteSpan packed;         ///< as far as it is in the file
    std::uint32_t checksum;  ///< CRC-32 of the uncompressed records; 0 for none
    bool sound;              ///< its opcode and lengths agree
  };
  /// The parts of a whole chunk record, whose data may be cut.
  virtual PackedChunk open_chunk(ByteReader record) = 0;

  Bytes index_at(std::uint64_t begin, std::uint64_t end);
  void take_index(ByteSpan index);
  /// Once a compressed chunk was located, only chunks are searched: compressed data contain pieces of records.
  void note_compression(std::string_view method) { packed_ = packed_ || (!method.empty() && method != "none"); }
  bool packed() const { return packed_; }
  /// Extends the time span of the messages.
  void extend(Timestamp t);
  void repair(const std::string& kind, const std::string& detail, std::size_t count = 1);

  std::vector<Topic> topics_;

 private:
  void count_damage(std::uint64_t at, const std::string& reason, std::optional<std::uint64_t> next) final;
  void read_through();
  void load(Bytes records);
  bool load_next_record(std::optional<std::size_t> only);
  bool may_hold(const RecordPlace& chunk, std::size_t topic) const;
  Bytes unpack(const RecordPlace& chunk, ByteSpan record);
  void compare_counts();

  std::string name_;
  Repairs* repairs_;
  std::map<std::size_t, std::size_t> read_;  ///< number of messages of each topic
  bool packed_ = false;
  bool compared_ = false;  ///< with the numbers of the index
  Timestamp first_ = Timestamp::max(), last_ = Timestamp::min();
  Bytes records_;  ///< the records being read
  ByteReader reader_{ByteSpan()};
};

/// Writes messages in chunks, each followed by the index of its messages, and a summary at the end.
class RecordWriter : public MessageSink {
 public:
  void write(std::size_t topic, Timestamp t, std::string_view message) final;
  /// Call before and after messages whose times differ from their neighbours: readers find messages by the times of
  /// their chunk.
  void close_chunk();
  void finish() final;

 protected:
  struct TopicRecords {
    std::string schema, channel;  ///< the records that describe the topic
    bool written = false;         ///< they are in a chunk
    std::uint64_t messages = 0;
  };
  struct IndexEntry {
    Timestamp t;
    std::uint64_t offset;  ///< place of the message among the records of the chunk
  };
  struct ChunkInfo {
    std::uint64_t place = 0, bytes = 0;      ///< offset and length of its record in the file
    std::uint64_t packed = 0, unpacked = 0;  ///< lengths of its records
    Timestamp begin = Timestamp::max(), end = Timestamp::min();
    struct TopicIndex {
      std::uint64_t place;  ///< offset of its record in the file
      std::size_t messages;
    };
    std::map<std::size_t, TopicIndex> topics = {};
    std::uint64_t index_bytes = 0;
  };

  RecordWriter(const std::filesystem::path& file, const ChunkOptions& options) : file_(file), options_(options) {}

  // The description of a format: the bytes of its records.

  virtual std::string message_record(std::size_t topic, Timestamp t, std::string_view message) const = 0;
  virtual std::string chunk_record(const ChunkInfo& chunk, std::string_view packed) const = 0;
  virtual std::string index_record(std::size_t topic, const std::vector<IndexEntry>& entries) const = 0;
  virtual void write_summary() = 0;

  OutputFile file_;
  ChunkOptions options_;
  std::vector<TopicRecords> topics_;
  std::vector<ChunkInfo> chunks_;

 private:
  std::string records_;                                   ///< the chunk that is being filled
  std::map<std::size_t, std::vector<IndexEntry>> index_;  ///< index of that chunk, by topic
};

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

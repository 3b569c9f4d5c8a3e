// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The records of an MCAP file, with a summary as index.
#include "edged/io/ros/bag/message_records.hpp"

#include <spdlog/fmt/fmt.h>
#include <zlib.h>

#include <algorithm>

#include "edged/io/parse/text_parsing.hpp"

namespace edged {
namespace {

enum McapOp : std::uint8_t {
  kMcapNone = 0,
  kMcapHeader = 1,
  kMcapFooter = 2,
  kMcapSchema = 3,
  kMcapChannel = 4,
  kMcapMessage = 5,
  kMcapChunk = 6,
  kMcapMessageIndex = 7,
  kMcapChunkIndex = 8,
  kMcapStatistics = 0x0B,
  kMcapMetadata = 0x0C,
  kMcapMetadataIndex = 0x0D,
  kMcapDataEnd = 0x0F
};

constexpr std::uint64_t kMcapRecordHead = 9;  // opcode and length
constexpr std::uint64_t kMcapMessageHead = 22;
constexpr std::size_t kMcapChunkHead = 64;  // enough for the opcode and the fields before the records

Timestamp take_mcap_time(ByteReader& reader) {
  const auto ns = reader.number<std::uint64_t>();
  if (ns > static_cast<std::uint64_t>(kMaxStampNs)) throw Damage("stamp out of range");
  return timestamp_from_ns(static_cast<std::int64_t>(ns));
}

std::uint64_t mcap_time(Timestamp t) { return static_cast<std::uint64_t>(std::max<std::int64_t>(to_ns(t), 0)); }

/// Appends numbers in the order of the fields of a record.
template <typename... Numbers>
void append_numbers(std::string& out, Numbers... numbers) {
  (append_number(out, numbers), ...);
}

std::string mcap_record(McapOp op, std::string_view content) {
  std::string record;
  append_numbers(record, static_cast<std::uint8_t>(op), std::uint64_t{content.size()});
  record += content;
  return record;
}

/// The fields of a chunk before its records.
struct McapChunkHead {
  std::uint64_t bytes;     ///< uncompressed
  std::uint32_t checksum;  ///< CRC-32 of the uncompressed records; 0 for none
  std::string_view compression;
  std::uint64_t packed;
};

/// record: after its opcode. Nothing if the lengths contradict each other.
std::optional<McapChunkHead> take_chunk_head(ByteReader& record) {
  const auto stated = record.number<std::uint64_t>();
  const std::size_t begin = record.at();
  record.take(8 + 8);  // first and last time
  McapChunkHead head{record.number<std::uint64_t>(), record.number<std::uint32_t>(), take_text(record), 0};
  head.packed = record.number<std::uint64_t>();
  const std::size_t fields = record.at() - begin;
  return stated >= fields && stated - fields == head.packed ? std::optional(head) : std::nullopt;
}

/// A chunk is known by its lengths: the opcode may be damaged.
std::optional<McapChunkHead> find_chunk_head(ByteSpan bytes) try {
  ByteReader record(bytes);
  record.take(1);
  return take_chunk_head(record);
} catch (const Damage&) {
  return std::nullopt;
}

/// A record is an opcode, a length and its content. Topics that are not of ROS are listed by name only.
class Mcap final : public RecordSource {
 public:
  Mcap(const BagFile& file, Repairs* repairs) : RecordSource(file, kMcapMagic.size(), repairs) { find_topics(); }

  Wire wire() const override { return wire_; }

 private:
  RecordPlace locate(std::uint64_t at) override {
    const Bytes head = file().read(at, kMcapChunkHead);
    ByteReader fields(head);
    const auto op = fields.number<std::uint8_t>();
    RecordPlace place{at, at + kMcapRecordHead, fields.number<std::uint64_t>(), kSkipped};
    if ((op == kMcapDataEnd && place.bytes == 4) || (op == kMcapFooter && place.bytes == 20)) {
      place.bytes = file().size() - place.data;  // nothing but the summary follows
      return place;
    }
    const auto chunk = find_chunk_head(head);
    place.closed = chunk.has_value();
    if (chunk) note_compression(chunk->compression);
    if (!place.closed && (op == kMcapNone || op == kMcapFooter || op == kMcapChunk)) throw Damage("no record");
    if (place.closed || op < kMcapChunk) place.kind = place.closed ? kChunk : kPlain;
    if (place.bytes > (place.kind == kSkipped ? file().size() : kLargestRecord)) throw Damage("record too long");
    return place;
  }

  /// A chunk, or a message, which a damaged chunk without compression may hold.
  bool begins_record(ByteSpan bytes) const override try {
    ByteReader record(bytes);
    const auto op = record.number<std::uint8_t>();
    if (op == kMcapChunk) return find_chunk_head(bytes).has_value();
    if (op != kMcapMessage || packed()) return false;
    if (record.number<std::uint64_t>() < kMcapMessageHead) return false;
    if (!topic_of_channel_.contains(record.number<std::uint16_t>())) return false;
    record.take(4);  // sequence
    return to_ns(take_mcap_time(record)) > 0;
  } catch (const Damage&) {
    return false;
  }

  /// Schemas, channels and counts lie between the end of the data and the footer, which has a fixed size.
  void read_index() override {
    constexpr std::uint64_t kFooterBytes = kMcapRecordHead + 20;
    if (file().size() < kFooterBytes + 2 * kMcapMagic.size()) throw Damage("no footer");
    const std::uint64_t end = file().size() - kMcapMagic.size() - kFooterBytes;
    const Bytes tail = file().read(end, kFooterBytes);
    ByteReader footer(tail);
    if (footer.number<std::uint8_t>() != kMcapFooter || footer.number<std::uint64_t>() != 20) throw Damage("no footer");
    const auto begin = footer.number<std::uint64_t>();
    footer.take(8);  // offset of a table of the summary
    const std::size_t after = footer.at();
    const auto checksum = footer.number<std::uint32_t>();
    const Bytes summary = index_at(begin, end + after);  // as far as its checksum goes
    if (checksum != 0 && crc32_z(0, summary.data(), summary.size()) != checksum) throw Damage("checksum differs");
    if (begin < end) take_index(ByteSpan(summary).first(static_cast<std::size_t>(end - begin)));
    if (!counted_) throw Damage("no counts");
  }

  void forget() override {
    schemas_.clear();
    topic_of_channel_.clear();
  }

  std::optional<Message> take_record(ByteReader& records) override {
    const auto op = records.number<std::uint8_t>();
    if (op == kMcapNone) throw Damage("no record");
    ByteReader record(records.take(records.number<std::uint64_t>()));
    if (op == kMcapSchema) take_schema(record);
    if (op == kMcapChannel) take_channel(record);
    if (op == kMcapStatistics) take_statistics(record);
    if (op == kMcapChunkIndex) take_chunk_index(record);
    return op == kMcapMessage ? take_message(record) : std::nullopt;
  }

  void take_schema(ByteReader& record) {
    const auto id = record.number<std::uint16_t>();
    const std::string_view type = take_text(record), encoding = take_text(record);
    schemas_[id] = {std::string(type), encoding.starts_with("ros") ? std::string(take_text(record)) : ""};
  }

  void take_channel(ByteReader& record) {
    const auto id = record.number<std::uint16_t>();
    const auto schema = schemas_.find(record.number<std::uint16_t>());
    const std::string_view topic = take_text(record), encoding = take_text(record);
    if (topic_of_channel_.contains(id)) return;
    if (schema == schemas_.end()) {
      topic_of_channel_[id] = std::nullopt;
      return;
    }
    const auto& [type, definition] = schema->second;
    if (encoding == "ros1") wire_ = Wire::Ros1;
    const bool ros = encoding == "cdr" || encoding == "ros1";
    topic_of_channel_[id] =
        topic_index(topics_, topic, ros ? type : fmt::format("{} in {}", type, encoding), definition);
  }

  std::optional<std::size_t> topic_of(std::uint16_t channel) const {
    const auto found = topic_of_channel_.find(channel);
    return found == topic_of_channel_.end() ? std::nullopt : found->second;
  }

  std::optional<Message> take_message(ByteReader& record) {
    const auto channel = record.number<std::uint16_t>();
    record.take(4);  // sequence
    const Timestamp t = take_mcap_time(record);
    record.take(8);  // time of publication
    if (!topic_of_channel_.contains(channel)) repair("message of an unknown topic", fmt::format("channel {}", channel));
    const auto topic = topic_of(channel);
    if (!topic) return std::nullopt;
    extend(t);
    return Message{*topic, record.take(record.left())};
  }

  void take_statistics(ByteReader& record) {
    counted_ = true;
    record.take(8 + 2 + 4 + 4 + 4 + 4);  // counts of messages, schemas, channels, attachments, metadata, chunks
    extend(take_mcap_time(record));
    extend(take_mcap_time(record));
    for (auto left = record.number<std::uint32_t>() / 10; left > 0; --left) {
      const auto topic = topic_of(record.number<std::uint16_t>());
      const auto count = record.number<std::uint64_t>();
      if (topic) topics_[*topic].count += count;
    }
  }

  void take_chunk_index(ByteReader& record) {
    record.take(8 + 8);  // first and last time
    std::vector<std::size_t>& topics = index_[record.number<std::uint64_t>()];
    record.take(8);  // length of the chunk
    for (auto left = record.number<std::uint32_t>() / 10; left > 0; --left) {
      const auto topic = topic_of(record.number<std::uint16_t>());
      record.take(8);                     // offset of its message index
      if (!topic) return topics.clear();  // the channel may be described later
      topics.push_back(*topic);
    }
  }

  PackedChunk open_chunk(ByteReader record) override {
    const bool sound = record.number<std::uint8_t>() == kMcapChunk;
    const auto head = take_chunk_head(record);
    if (!head) throw Damage("no chunk");
    return {head->compression, head->bytes, record.take(record.left()), head->checksum, sound};
  }

  struct Schema {
    std::string type, definition;
  };
  Wire wire_ = Wire::Cdr;
  bool counted_ = false;  ///< the index holds statistics
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::optional<std::size_t>> topic_of_channel_;  ///< nothing: of no known type
};

}  // namespace

std::unique_ptr<MessageSource> open_mcap(const BagFile& file, Repairs* repairs) {
  return std::make_unique<Mcap>(file, repairs);
}

McapWriter::McapWriter(const std::filesystem::path& file, std::string_view profile, const ChunkOptions& options)
    : RecordWriter(file, options) {
  file_.write(kMcapMagic);
  std::string header;
  append_sized(header, profile);
  append_sized(header, "edged");
  file_.write(mcap_record(kMcapHeader, header));
}

std::size_t McapWriter::add_topic(std::string_view name, std::string_view type, const MessageDefinition& definition) {
  const std::string long_type = ros2_type(type);
  return add_topic({name, "cdr", long_type, "ros2msg", definition.text});
}

std::size_t McapWriter::add_topic(const McapTopic& topic) {
  const auto id = static_cast<std::uint16_t>(topics_.size()), schema_id = static_cast<std::uint16_t>(id + 1);
  std::string schema, channel;
  append_number(schema, schema_id);  // zero: no schema
  append_sized(schema, topic.type);
  append_sized(schema, topic.type_encoding);
  append_sized(schema, topic.type_text);
  append_numbers(channel, id, schema_id);
  append_sized(channel, topic.name);
  append_sized(channel, topic.encoding);
  append_number<std::uint32_t>(channel, 0);  // no further properties
  topics_.push_back({mcap_record(kMcapSchema, schema), mcap_record(kMcapChannel, channel)});
  return id;
}

std::string McapWriter::message_record(std::size_t topic, Timestamp t, std::string_view message) const {
  const std::uint64_t recorded = mcap_time(t), published = recorded;
  std::string content;
  append_numbers(content, static_cast<std::uint16_t>(topic), static_cast<std::uint32_t>(topics_[topic].messages),
                 recorded, published);
  content += message;
  return mcap_record(kMcapMessage, content);
}

std::string McapWriter::chunk_record(const ChunkInfo& chunk, std::string_view packed) const {
  std::string content;
  // A compression has its own checksum.
  const auto checksum =
      options_.compression.empty() ? static_cast<std::uint32_t>(crc32_z(0, as_bytes(packed).data(), packed.size())) : 0;
  append_numbers(content, mcap_time(chunk.begin), mcap_time(chunk.end), chunk.unpacked, checksum);
  append_sized(content, options_.compression);
  append_number(content, chunk.packed);
  content += packed;
  return mcap_record(kMcapChunk, content);
}

std::string McapWriter::index_record(std::size_t topic, const std::vector<IndexEntry>& entries) const {
  std::string content;
  append_numbers(content, static_cast<std::uint16_t>(topic), static_cast<std::uint32_t>(16 * entries.size()));
  for (const IndexEntry& entry : entries) append_numbers(content, mcap_time(entry.t), entry.offset);
  return mcap_record(kMcapMessageIndex, content);
}

void McapWriter::write_metadata(std::string_view name, const std::map<std::string, std::string>& values) {
  std::string pairs, content, index;
  for (const auto& [key, value] : values) append_sized(pairs, key), append_sized(pairs, value);
  append_sized(content, name);
  append_sized(content, pairs);
  const std::string record = mcap_record(kMcapMetadata, content);
  append_numbers(index, file_.size(), std::uint64_t{record.size()});
  append_sized(index, name);
  metadata_index_.push_back(mcap_record(kMcapMetadataIndex, index));
  file_.write(record);
}

std::string McapWriter::statistics() const {
  const auto topics = static_cast<std::uint32_t>(topics_.size());
  std::uint64_t messages = 0, begin = UINT64_MAX, end = 0;
  for (const TopicRecords& topic : topics_) messages += topic.messages;
  for (const ChunkInfo& chunk : chunks_)
    begin = std::min(begin, mcap_time(chunk.begin)), end = std::max(end, mcap_time(chunk.end));
  std::string content;
  const std::uint32_t attachments = 0;
  append_numbers(content, messages, static_cast<std::uint16_t>(topics), topics, attachments,
                 static_cast<std::uint32_t>(metadata_index_.size()), static_cast<std::uint32_t>(chunks_.size()),
                 chunks_.empty() ? 0 : begin, end, 10 * topics);
  for (std::size_t i = 0; i < topics_.size(); ++i)
    append_numbers(content, static_cast<std::uint16_t>(i), topics_[i].messages);
  return mcap_record(kMcapStatistics, content);
}

std::string McapWriter::chunk_index(const ChunkInfo& chunk) const {
  std::string content;
  append_numbers(content, mcap_time(chunk.begin), mcap_time(chunk.end), chunk.place, chunk.bytes,
                 static_cast<std::uint32_t>(10 * chunk.topics.size()));
  for (const auto& [topic, index] : chunk.topics)
    append_numbers(content, static_cast<std::uint16_t>(topic), index.place);
  append_number(content, chunk.index_bytes);
  append_sized(content, options_.compression);
  append_numbers(content, chunk.packed, chunk.unpacked);
  return mcap_record(kMcapChunkIndex, content);
}

void McapWriter::write_summary() {
  constexpr std::uint32_t kNoChecksum = 0;
  constexpr std::uint64_t kNoSummaryOffsets = 0;
  std::string data_end, footer;
  append_number(data_end, kNoChecksum);
  file_.write(mcap_record(kMcapDataEnd, data_end));
  append_numbers(footer, file_.size(), kNoSummaryOffsets, kNoChecksum);
  for (const TopicRecords& topic : topics_) file_.write(topic.schema);
  for (const TopicRecords& topic : topics_) file_.write(topic.channel);
  file_.write(statistics());
  for (const ChunkInfo& chunk : chunks_) file_.write(chunk_index(chunk));
  for (const std::string& record : metadata_index_) file_.write(record);
  file_.write(mcap_record(kMcapFooter, footer));
  file_.write(kMcapMagic);
}

}  // namespace edged

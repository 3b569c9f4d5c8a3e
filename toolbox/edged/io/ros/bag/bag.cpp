// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// ROS 1 bags of version 2.0: the records, a header of `name=value` fields and data, each after its length.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <map>

#include "edged/io/ros/bag/message_records.hpp"

namespace edged {
namespace {

enum BagOp : std::uint8_t {
  kBagMessage = 2,
  kBagHeader = 3,
  kBagIndex = 4,
  kBagChunk = 5,
  kBagChunkInfo = 6,
  kBagConnection = 7
};

constexpr std::uint32_t kLongestHeader = 1U << 20U;  // longer ones are damage
constexpr std::size_t kBagHeadBytes = 4096;          // of the first record, padded

/// The fields of the header of a record.
class BagFields {
 public:
  explicit BagFields(ByteSpan bytes) {
    for (ByteReader reader(bytes); reader.left() > 0;) {
      const std::string_view field = take_text(reader);
      const std::size_t equals = field.find('=');
      if (equals == std::string_view::npos) throw Damage("field without `=`");
      fields_[field.substr(0, equals)] = field.substr(equals + 1);
    }
  }

  bool has(std::string_view name) const { return fields_.contains(name); }

  std::string_view text(std::string_view name) const {
    const auto found = fields_.find(name);
    if (found == fields_.end()) throw Damage("no field " + std::string(name));
    return found->second;
  }

  template <typename T>
  T number(std::string_view name) const {
    return ByteReader(as_bytes(text(name))).number<T>();
  }

  Timestamp time(std::string_view name) const {
    const auto value = number<std::uint64_t>(name);
    return timestamp_from_ns(static_cast<std::int64_t>((value & 0xFFFFFFFFU) * 1'000'000'000 + (value >> 32U)));
  }

 private:
  std::map<std::string_view, std::string_view> fields_;
};

std::uint64_t bag_time(Timestamp t) {
  // For tools, the time zero means that it is not set.
  const auto ns = static_cast<std::uint64_t>(std::max<std::int64_t>(to_ns(t), 1));
  return ns / 1'000'000'000 | (ns % 1'000'000'000) << 32U;
}

/// Writes the fields that BagFields reads.
class BagHeader {
 public:
  BagHeader() = default;
  explicit BagHeader(BagOp op) { number("op", static_cast<std::uint8_t>(op)); }

  template <typename T>
  BagHeader& number(std::string_view name, T value) {
    std::string bytes;
    append_number(bytes, value);
    return text(name, bytes);
  }
  BagHeader& text(std::string_view name, std::string_view value) {
    append_sized(fields_, std::string(name).append("=").append(value));
    return *this;
  }
  const std::string& bytes() const { return fields_; }

 private:
  std::string fields_;
};

std::string bag_record(const BagHeader& header, std::string_view data) {
  std::string record;
  append_sized(record, header.bytes());
  append_sized(record, data);
  return record;
}

/// A record has a header with named fields, and data.
class Bag final : public RecordSource {
 public:
  Bag(const BagFile& file, Repairs* repairs) : RecordSource(file, kBagMagic.size(), repairs) { find_topics(); }

  Wire wire() const override { return Wire::Ros1; }

 private:
  void forget() override { topic_of_connection_.clear(); }

  RecordPlace locate(std::uint64_t at) override {
    const Bytes length = file().read(at, 4);
    const auto header_bytes = ByteReader(length).number<std::uint32_t>();
    if (header_bytes > kLongestHeader) throw Damage("header of a record too long");
    const Bytes head = file().read(at + 4, header_bytes + 4);
    ByteReader reader(head);
    const BagFields fields(reader.take(header_bytes));
    const auto op = fields.number<std::uint8_t>("op");
    RecordPlace place{at, at + 8 + header_bytes, reader.number<std::uint32_t>(), kSkipped};
    if (fields.has("compression")) {  // its opcode may be damaged
      place.kind = kChunk;
      place.closed = fields.text("compression") == "none";
      note_compression(fields.text("compression"));
      // Of two lengths, the one is right behind which a record begins.
      const auto size = fields.number<std::uint32_t>("size");
      if (place.closed && size != place.bytes && record_begins(place.data + size))
        place.bytes = size;
      else if (place.closed && size != place.bytes && !record_begins(place.end()))
        throw Damage("the lengths of a chunk contradict each other");
    } else if (op == kBagMessage || op == kBagConnection) {
      place.kind = kPlain;
    } else if (op < kBagMessage || op > kBagConnection || op == kBagChunk) {
      throw Damage("no record");
    }
    if (place.kind != kSkipped && place.bytes > kLargestRecord) throw Damage("record too long");
    return place;
  }

  bool begins_record(ByteSpan bytes) const override try {
    ByteReader record(bytes);
    const std::size_t length = bytes.size() < 4 ? 0 : record.number<std::uint32_t>();
    if (length == 0 || length > record.left()) return false;  // by far most often
    const std::string_view header = record.text(length);
    return header.find("op=") != header.npos && BagFields(as_bytes(header)).has(packed() ? "compression" : "op");
  } catch (const Damage&) {
    return false;
  }

  void read_index() override {
    const RecordPlace head = locate(first_record());
    const Bytes record = bytes_of(head);
    ByteReader reader(record);
    const auto place = BagFields(take_sized(reader)).number<std::uint64_t>("index_pos");
    if (place < head.end()) throw Damage("unfinished");
    take_index(index_at(place, file().size()));
  }

  std::optional<Message> take_record(ByteReader& records) override {
    const BagFields header(take_sized(records));
    const ByteSpan data = take_sized(records);
    const auto op = header.number<std::uint8_t>("op");
    if (op == kBagConnection) take_connection(header, data);
    if (op == kBagChunkInfo) take_chunk_info(header, data);
    if (op != kBagMessage) return std::nullopt;
    const auto connection = topic_of_connection_.find(header.number<std::uint32_t>("conn"));
    if (connection == topic_of_connection_.end()) {
      repair("message of an unknown topic", fmt::format("connection {}", header.number<std::uint32_t>("conn")));
      return std::nullopt;
    }
    extend(header.time("time"));
    return Message{connection->second, data};
  }

  PackedChunk open_chunk(ByteReader record) override {
    const BagFields header(take_sized(record));
    const auto stated = record.number<std::uint32_t>(), size = header.number<std::uint32_t>("size");
    const std::string_view compression = header.text("compression");
    const bool sound = header.number<std::uint8_t>("op") == kBagChunk && (compression != "none" || stated == size);
    return {compression, size, record.take(record.left()), 0, sound};
  }

  void take_connection(const BagFields& header, ByteSpan data) {
    const auto id = header.number<std::uint32_t>("conn");
    if (topic_of_connection_.contains(id)) return;
    const BagFields fields(data);
    topic_of_connection_[id] =
        topic_index(topics_, header.text("topic"), fields.text("type"), fields.text("message_definition"));
  }

  /// The position of a chunk, its time span, and its number of messages of each connection.
  void take_chunk_info(const BagFields& header, ByteSpan data) {
    extend(header.time("start_time"));
    extend(header.time("end_time"));
    std::vector<std::size_t> topics;
    ByteReader counts(data);
    for (auto left = header.number<std::uint32_t>("count"); left > 0; --left) {
      const auto connection = topic_of_connection_.find(counts.number<std::uint32_t>());
      if (connection == topic_of_connection_.end()) throw Damage("unknown connection");
      topics_[connection->second].count += counts.number<std::uint32_t>();
      topics.push_back(connection->second);
    }
    index_[header.number<std::uint64_t>("chunk_pos")] = std::move(topics);
  }

  std::map<std::uint32_t, std::size_t> topic_of_connection_;
};

/// Writes the index that ROS tools require.
class BagWriter final : public RecordWriter {
 public:
  BagWriter(const std::filesystem::path& file, const ChunkOptions& options) : RecordWriter(file, options) {
    file_.write(kBagMagic);
    file_.write(head(0));
  }

  Wire wire() const override { return Wire::Ros1; }

  std::size_t add_topic(std::string_view name, std::string_view type, const MessageDefinition& definition) override {
    const std::size_t id = topics_.size();
    const BagHeader header =
        BagHeader(kBagConnection).number("conn", static_cast<std::uint32_t>(id)).text("topic", name);
    const BagHeader data = BagHeader()
                               .text("topic", name)
                               .text("type", type)
                               .text("md5sum", definition.md5)
                               .text("message_definition", definition.text);
    topics_.push_back({"", bag_record(header, data.bytes())});
    return id;
  }

 private:
  /// The first record. index_place: 0 while the bag is unfinished, which states that there is no index.
  std::string head(std::uint64_t index_place) const {
    const BagHeader header = BagHeader(kBagHeader)
                                 .number("index_pos", index_place)
                                 .number("conn_count", static_cast<std::uint32_t>(topics_.size()))
                                 .number("chunk_count", static_cast<std::uint32_t>(chunks_.size()));
    return bag_record(header, std::string(kBagHeadBytes - 8 - header.bytes().size(), ' '));
  }

  std::string message_record(std::size_t topic, Timestamp t, std::string_view message) const override {
    return bag_record(
        BagHeader(kBagMessage).number("conn", static_cast<std::uint32_t>(topic)).number("time", bag_time(t)), message);
  }

  std::string chunk_record(const ChunkInfo& chunk, std::string_view packed) const override {
    return bag_record(BagHeader(kBagChunk)
                          .text("compression", options_.compression)
                          .number("size", static_cast<std::uint32_t>(chunk.unpacked)),
                      packed);
  }

  std::string index_record(std::size_t topic, const std::vector<IndexEntry>& entries) const override {
    std::string data;
    for (const IndexEntry& entry : entries) {
      append_number(data, bag_time(entry.t));
      append_number(data, static_cast<std::uint32_t>(entry.offset));
    }
    return bag_record(BagHeader(kBagIndex)
                          .number("ver", std::uint32_t{1})
                          .number("conn", static_cast<std::uint32_t>(topic))
                          .number("count", static_cast<std::uint32_t>(entries.size())),
                      data);
  }

  void write_summary() override {
    const std::uint64_t index_place = file_.size();
    for (const TopicRecords& topic : topics_) file_.write(topic.channel);
    for (const ChunkInfo& chunk : chunks_) {
      const BagHeader header = BagHeader(kBagChunkInfo)
                                   .number("ver", std::uint32_t{1})
                                   .number("chunk_pos", chunk.place)
                                   .number("start_time", bag_time(chunk.begin))
                                   .number("end_time", bag_time(chunk.end))
                                   .number("count", static_cast<std::uint32_t>(chunk.topics.size()));
      std::string data;
      for (const auto& [topic, index] : chunk.topics) {
        append_number(data, static_cast<std::uint32_t>(topic));
        append_number(data, static_cast<std::uint32_t>(index.messages));
      }
      file_.write(bag_record(header, data));
    }
    file_.overwrite(kBagMagic.size(), head(index_place));
  }
};

}  // namespace

std::unique_ptr<MessageSource> open_ros1_bag(const BagFile& file, Repairs* repairs) {
  return std::make_unique<Bag>(file, repairs);
}

std::unique_ptr<MessageSink> create_ros1_bag(const std::filesystem::path& file, const ChunkOptions& options) {
  return std::make_unique<BagWriter>(file, options);
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The records of a bag.
#include "edged/io/ros/bag/bag.hpp"

#include <spdlog/fmt/fmt.h>

#include "edged/io/archive/compression.hpp"
#include "edged/io/ros/bag/bag_format.hpp"

namespace edged {

/// A field `name=value` of the header of a record.
class BagFields {
 public:
  explicit BagFields(ByteSpan bytes) {
    for (ByteReader reader(bytes); reader.left() > 0;) {
      const std::string_view field = reader.text(reader.number<std::uint32_t>());
      const std::size_t equals = field.find('=');
      if (equals == std::string_view::npos) throw Damage("field without `=`");
      fields_[field.substr(0, equals)] = field.substr(equals + 1);
    }
  }

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

namespace {

constexpr std::uint64_t kFirstRecord = kBagMagic.size();
constexpr std::uint32_t kLongestHeader = 1U << 20U;  // longer ones are damage
constexpr std::uint32_t kLargestChunk = 1U << 30U;   // uncompressed; 768 kB are usual

/// The position of a record in the file. Its data may extend beyond the end of a cut file.
struct BagRecord {
  Bytes header;
  std::uint64_t data = 0;
  std::uint32_t size = 0;
  std::uint64_t end() const { return data + size; }
};

BagRecord locate_record(BinaryFile& file, std::uint64_t at) {
  const Bytes length = file.read(at, 4);
  const auto header_size = ByteReader(length).number<std::uint32_t>();
  if (header_size > kLongestHeader) throw Damage("header of a record too long");
  BagRecord record{file.read(at + 4, header_size + 4), at + 8 + header_size, 0};
  ByteReader reader(record.header);
  reader.take(header_size);
  record.size = reader.number<std::uint32_t>();
  record.header.resize(header_size);
  return record;
}

}  // namespace

Bag::Bag(const std::filesystem::path& path, Repairs* repairs) : RecordSource(path, kFirstRecord, repairs) {
  find_topics();
}

void Bag::read_index() {
  const BagRecord head = locate_record(file(), kFirstRecord);
  std::uint64_t place = BagFields(head.header).number<std::uint64_t>("index_pos");
  if (place < head.end() || place >= file().size()) throw Damage("unfinished");
  while (place < file().size()) {
    const BagRecord record = locate_record(file(), place);
    if (record.end() > file().size() || record.size > kLargestChunk) throw Damage("index cut");
    const BagFields fields(record.header);
    const Bytes data = file().read(record.data, record.size);
    const auto op = fields.number<std::uint8_t>("op");
    if (op == kBagConnection) add_connection(fields, data);
    if (op == kBagChunkInfo) add_chunk_info(fields, data);
    place = record.end();
  }
}

/// Loads the records of a chunk, or a record outside chunks, for reading.
bool Bag::load_record() {
  const std::uint64_t begin = at();
  const BagRecord record = locate_record(file(), begin);
  const BagFields fields(record.header);
  const auto op = fields.number<std::uint8_t>("op");
  go_to(record.end());
  if (op != kBagChunk && op != kBagMessage && op != kBagConnection) return false;
  if (op == kBagChunk && !is_of_use(begin)) return false;
  if (record.size > kLargestChunk) throw Damage("record too long");
  const bool cut = record.end() > file().size();
  if (cut) repair("cut", "the file ends within a record");
  if (op != kBagChunk) {
    load(file().read(begin, static_cast<std::size_t>(record.end() - begin)));
    return true;
  }
  const auto size = fields.number<std::uint32_t>("size");
  if (size > kLargestChunk) throw Damage("chunk too long");
  Decompressed chunk = decompress(fields.text("compression"), file().read(record.data, record.size), size);
  if ((!chunk.whole || chunk.bytes.size() != size) && !cut)
    repair("chunk damaged", fmt::format("chunk at byte {} is not whole", begin));
  load(std::move(chunk.bytes));
  return true;
}

std::optional<Message> Bag::take_message() {
  const BagFields fields(reader().take(reader().number<std::uint32_t>()));
  const ByteSpan data = reader().take(reader().number<std::uint32_t>());
  const auto op = fields.number<std::uint8_t>("op");
  if (op == kBagConnection) add_connection(fields, data);
  if (op != kBagMessage) return std::nullopt;
  const auto connection = topic_of_connection_.find(fields.number<std::uint32_t>("conn"));
  if (connection == topic_of_connection_.end()) throw Damage("message of an unknown connection");
  extend(fields.time("time"));
  return Message{connection->second, data};
}

void Bag::add_connection(const BagFields& header, ByteSpan data) {
  const auto id = header.number<std::uint32_t>("conn");
  if (topic_of_connection_.contains(id)) return;
  const BagFields fields(data);
  topic_of_connection_[id] =
      describe_topic(header.text("topic"), fields.text("type"), fields.text("message_definition"));
}

/// The position of a chunk, its time span, and its number of messages of each connection.
void Bag::add_chunk_info(const BagFields& header, ByteSpan data) {
  extend(header.time("start_time"));
  extend(header.time("end_time"));
  std::vector<std::size_t> topics;
  ByteReader counts(data);
  for (auto left = header.number<std::uint32_t>("count"); left > 0; --left) {
    const auto connection = topic_of_connection_.find(counts.number<std::uint32_t>());
    if (connection == topic_of_connection_.end()) throw Damage("unknown connection");
    count_messages(connection->second, counts.number<std::uint32_t>());
    topics.push_back(connection->second);
  }
  add_chunk(header.number<std::uint64_t>("chunk_pos"), std::move(topics));
}

}  // namespace edged

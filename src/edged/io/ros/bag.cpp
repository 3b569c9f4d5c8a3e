// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The records of a bag.
#include "edged/io/ros/bag.hpp"

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/compression.hpp"

namespace edged {

/// `name=value` of a record's header.
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
    const std::string_view value = text(name);
    return ByteReader({reinterpret_cast<const std::uint8_t*>(value.data()), value.size()}).number<T>();
  }

  Timestamp time(std::string_view name) const {
    const auto value = number<std::uint64_t>(name);
    return timestamp_from_ns(static_cast<std::int64_t>((value & 0xFFFFFFFFU) * 1'000'000'000 + (value >> 32U)));
  }

 private:
  std::map<std::string_view, std::string_view> fields_;
};

namespace {

constexpr std::uint64_t kFirstRecord = 13;           // behind "#ROSBAG V2.0\n"
constexpr std::uint32_t kLongestHeader = 1U << 20U;  // longer ones are damage
constexpr std::uint32_t kLargestChunk = 1U << 30U;   // as recorded; usual are 768 kB
enum BagOp : std::uint8_t { kMessage = 2, kBagHeader = 3, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

/// Where a record of the file is. Its data may reach beyond the end of a cut file.
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

Bag::Bag(const std::filesystem::path& file, Repairs* repairs) : name_(file.string()), file_(file), repairs_(repairs) {
  if (!read_index()) read_through();
  if (topics_.empty()) throw InputError::format("{}: no messages in this bag: record it again", name_);
}

bool Bag::read_index() try {
  const BagRecord head = locate_record(file_, kFirstRecord);
  std::uint64_t at = BagFields(head.header).number<std::uint64_t>("index_pos");
  if (at < head.end() || at >= file_.size()) throw Damage("unfinished");
  while (at < file_.size()) {
    const BagRecord record = locate_record(file_, at);
    if (record.end() > file_.size() || record.size > kLargestChunk) throw Damage("index cut");
    const BagFields fields(record.header);
    const Bytes data = file_.read(record.data, record.size);
    const auto op = fields.number<std::uint8_t>("op");
    if (op == kConnection) add_connection(fields, data);
    if (op == kChunkInfo) {
      chunk_places_.push_back(fields.number<std::uint64_t>("chunk_pos"));
      extend(fields.time("start_time"));
      extend(fields.time("end_time"));
      ByteReader counts(data);
      for (auto left = fields.number<std::uint32_t>("count"); left > 0; --left) {
        const auto connection = topic_of_connection_.find(counts.number<std::uint32_t>());
        if (connection == topic_of_connection_.end()) throw Damage("unknown connection");
        topics_[connection->second].count += counts.number<std::uint32_t>();
      }
    }
    at = record.end();
  }
  std::ranges::sort(chunk_places_);
  rewind();
  return !topics_.empty();
} catch (const Damage&) {
  return false;
}

void Bag::read_through() {
  topics_.clear();
  topic_of_connection_.clear();
  chunk_places_.clear();
  first_ = Timestamp::max(), last_ = Timestamp::min();
  repair("no index",
         "its index is missing or damaged (a recorder that crashed?): reading all of it to find its topics");
  rewind();
  while (const auto message = next()) ++topics_[message->topic].count;
  repairs_ = nullptr;  // the next pass meets the same damage: it is counted already
  rewind();
}

void Bag::rewind() {
  at_ = kFirstRecord;
  reader_ = ByteReader(ByteSpan());
}

std::optional<Message> Bag::next() {
  while (reader_.left() > 0 || load_next_record())
    if (auto message = take_message()) return message;
  return std::nullopt;
}

/// Makes the records of the next chunk, or the next record outside chunks, those that are being read.
bool Bag::load_next_record() {
  while (at_ < file_.size()) {
    const std::uint64_t begin = at_;
    try {
      const BagRecord record = locate_record(file_, begin);
      const BagFields fields(record.header);
      const auto op = fields.number<std::uint8_t>("op");
      at_ = record.end();
      if (op != kChunk && op != kMessage && op != kConnection) continue;
      if (record.size > kLargestChunk) throw Damage("record too long");
      if (record.end() > file_.size()) repair("cut", "the file ends within a record");
      if (op == kChunk) {
        const auto size = fields.number<std::uint32_t>("size");
        if (size > kLargestChunk) throw Damage("chunk too long");
        Decompressed chunk = decompress(fields.text("compression"), file_.read(record.data, record.size), size);
        if ((!chunk.whole || chunk.bytes.size() != size) && record.end() <= file_.size())
          repair("chunk damaged", fmt::format("chunk at byte {} is not whole", begin));
        records_ = std::move(chunk.bytes);
      } else {
        records_ = file_.read(begin, static_cast<std::size_t>(record.end() - begin));
      }
      reader_ = ByteReader(records_);
      return true;
    } catch (const Damage& damage) {
      repair("record damaged", fmt::format("byte {}: {}", begin, damage.what()));
      const auto next_chunk = std::ranges::upper_bound(chunk_places_, begin);
      at_ = next_chunk == chunk_places_.end() ? file_.size() : *next_chunk;
    }
  }
  return false;
}

/// The next record in memory, if it is a message.
std::optional<Message> Bag::take_message() try {
  const BagFields fields(reader_.take(reader_.number<std::uint32_t>()));
  const ByteSpan data = reader_.take(reader_.number<std::uint32_t>());
  const auto op = fields.number<std::uint8_t>("op");
  if (op == kConnection) add_connection(fields, data);
  if (op != kMessage) return std::nullopt;
  const auto connection = topic_of_connection_.find(fields.number<std::uint32_t>("conn"));
  if (connection == topic_of_connection_.end()) throw Damage("message of an unknown connection");
  extend(fields.time("time"));
  return Message{connection->second, data};
} catch (const Damage& damage) {
  repair("chunk damaged", fmt::format("chunk before byte {}: {}", at_, damage.what()));
  reader_ = ByteReader(ByteSpan());
  return std::nullopt;
}

void Bag::add_connection(const BagFields& header, ByteSpan data) {
  const auto id = header.number<std::uint32_t>("conn");
  if (topic_of_connection_.contains(id)) return;
  topic_of_connection_[id] = topic_index(topics_, header.text("topic"), BagFields(data).text("type"));
}

void Bag::extend(Timestamp t) {
  first_ = std::min(first_, t);
  last_ = std::max(last_, t);
}

void Bag::repair(const std::string& kind, const std::string& detail) {
  if (repairs_) repairs_->add("bag: " + kind, name_ + ": " + detail);
}

}  // namespace edged

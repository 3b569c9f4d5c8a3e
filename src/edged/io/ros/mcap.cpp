// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The records of an MCAP file.
#include "edged/io/ros/mcap.hpp"

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/compression.hpp"
#include "edged/io/text.hpp"

namespace edged {
namespace {

constexpr std::uint64_t kMagicBytes = 8;
constexpr std::uint64_t kRecordHead = 9;             // opcode and length
constexpr std::uint64_t kLargestRecord = 1U << 30U;  // longer ones are damage
enum McapOp : std::uint8_t {
  kMcapFooter = 2,
  kMcapSchema = 3,
  kMcapChannel = 4,
  kMcapMessage = 5,
  kMcapChunk = 6,
  kMcapStatistics = 0x0B,
  kMcapDataEnd = 0x0F
};

std::string_view mcap_text(ByteReader& reader) { return reader.text(reader.number<std::uint32_t>()); }

Timestamp mcap_time(ByteReader& reader) {
  const auto ns = reader.number<std::uint64_t>();
  if (ns > static_cast<std::uint64_t>(kMaxStampNs)) throw Damage("stamp out of range");
  return timestamp_from_ns(static_cast<std::int64_t>(ns));
}

}  // namespace

Mcap::Mcap(const std::filesystem::path& file, Repairs* repairs) : name_(file.string()), file_(file), repairs_(repairs) {
  if (!read_summary()) read_through();
  if (topics_.empty()) throw InputError::format("{}: no messages in this file: record it again", name_);
}

/// Schemas, channels and counts lie between the end of the data and the footer, which has a fixed size.
bool Mcap::read_summary() try {
  constexpr std::uint64_t kFooterBytes = kRecordHead + 20;
  if (file_.size() < kFooterBytes + 2 * kMagicBytes) throw Damage("no footer");
  const std::uint64_t end = file_.size() - kMagicBytes - kFooterBytes;
  const Bytes tail = file_.read(end, kFooterBytes);
  ByteReader footer(tail);
  if (footer.number<std::uint8_t>() != kMcapFooter || footer.number<std::uint64_t>() != 20) throw Damage("no footer");
  const auto begin = footer.number<std::uint64_t>();
  if (begin < kMagicBytes || begin >= end || end - begin > kLargestRecord) throw Damage("no summary");

  bool counted = false;
  const Bytes summary = file_.read(begin, static_cast<std::size_t>(end - begin));
  for (ByteReader reader(summary); reader.left() > 0;) {
    const auto op = reader.number<std::uint8_t>();
    ByteReader record(reader.take(reader.number<std::uint64_t>()));
    if (take_description(op, record) || op != kMcapStatistics) continue;
    record.take(8 + 2 + 4 + 4 + 4 + 4);  // how many messages, schemas, channels, attachments, metadata, chunks
    first_ = mcap_time(record);
    last_ = mcap_time(record);
    for (auto left = record.number<std::uint32_t>() / 10; left > 0; --left) {
      const auto channel = topic_of_channel_.find(record.number<std::uint16_t>());
      if (channel == topic_of_channel_.end()) throw Damage("unknown channel");
      topics_[channel->second].count += record.number<std::uint64_t>();
    }
    counted = true;
  }
  rewind();
  return counted && !topics_.empty();
} catch (const Damage&) {
  return false;
}

void Mcap::read_through() {
  topics_.clear();
  schemas_.clear();
  topic_of_channel_.clear();
  first_ = Timestamp::max(), last_ = Timestamp::min();
  repair("no index",
         "its summary is missing or damaged (a recorder that crashed?): reading all of it to find its topics");
  rewind();
  while (const auto message = next()) ++topics_[message->topic].count;
  repairs_ = nullptr;  // the next pass meets the same damage: it is counted already
  rewind();
}

void Mcap::rewind() {
  at_ = kMagicBytes;
  reader_ = ByteReader(ByteSpan());
}

std::optional<Message> Mcap::next() {
  while (reader_.left() > 0 || load_next_record())
    if (auto message = take_message()) return message;
  return std::nullopt;
}

/// Makes the records of the next chunk, or the next record outside chunks, those that are being read.
bool Mcap::load_next_record() try {
  while (at_ < file_.size()) {
    const std::uint64_t begin = at_;
    const Bytes head = file_.read(begin, kRecordHead);
    ByteReader reader(head);
    const auto op = reader.number<std::uint8_t>();
    const auto size = reader.number<std::uint64_t>();
    if (op == kMcapDataEnd || op == kMcapFooter) break;
    if (size > kLargestRecord) throw Damage("record too long");
    at_ = begin + kRecordHead + size;
    if (op > kMcapChunk) continue;
    if (at_ > file_.size()) repair("cut", "the file ends within a record");
    records_ = file_.read(begin, static_cast<std::size_t>(kRecordHead + size));
    reader_ = ByteReader(records_);
    if (op != kMcapChunk) return true;

    reader_.take(kRecordHead + 8 + 8);  // from when to when
    const auto unpacked_size = reader_.number<std::uint64_t>();
    reader_.take(4);  // checksum: optional, and a damaged chunk shows
    const std::string_view method = mcap_text(reader_);
    const auto packed_size = reader_.number<std::uint64_t>();
    if (unpacked_size > kLargestRecord) throw Damage("chunk too long");
    const std::uint64_t there = std::min<std::uint64_t>(packed_size, reader_.left());
    Decompressed chunk =
        decompress(method, reader_.take(static_cast<std::size_t>(there)), static_cast<std::size_t>(unpacked_size));
    if ((!chunk.whole || chunk.bytes.size() != unpacked_size) && at_ <= file_.size())
      repair("chunk damaged", fmt::format("chunk at byte {} is not whole", begin));
    records_ = std::move(chunk.bytes);
    reader_ = ByteReader(records_);
    return true;
  }
  return false;
} catch (const Damage& damage) {
  repair("record damaged", fmt::format("before byte {}: {}", at_, damage.what()));
  at_ = file_.size();
  reader_ = ByteReader(ByteSpan());
  return false;
}

/// The next record in memory, if it is a message.
std::optional<Message> Mcap::take_message() try {
  const auto op = reader_.number<std::uint8_t>();
  ByteReader record(reader_.take(reader_.number<std::uint64_t>()));
  if (take_description(op, record) || op != kMcapMessage) return std::nullopt;
  const auto channel = topic_of_channel_.find(record.number<std::uint16_t>());
  record.take(4);  // sequence
  const Timestamp t = mcap_time(record);
  record.take(8);                                               // when it was published
  if (channel == topic_of_channel_.end()) return std::nullopt;  // no ROS message
  first_ = std::min(first_, t);
  last_ = std::max(last_, t);
  return Message{channel->second, record.take(record.left())};
} catch (const Damage& damage) {
  repair("chunk damaged", fmt::format("chunk before byte {}: {}", at_, damage.what()));
  reader_ = ByteReader(ByteSpan());
  return std::nullopt;
}

/// Schemas name types, channels topics; false for other records.
bool Mcap::take_description(std::uint8_t op, ByteReader& record) {
  if (op == kMcapSchema) {
    const auto id = record.number<std::uint16_t>();
    schemas_[id] = mcap_text(record);
    return true;
  }
  if (op != kMcapChannel) return false;
  const auto id = record.number<std::uint16_t>();
  const auto schema = schemas_.find(record.number<std::uint16_t>());
  const std::string_view topic = mcap_text(record), encoding = mcap_text(record);
  if (schema == schemas_.end() || (encoding != "cdr" && encoding != "ros1") || topic_of_channel_.contains(id))
    return true;
  wire_ = encoding == "ros1" ? Wire::Ros1 : Wire::Cdr;
  topic_of_channel_[id] = topic_index(topics_, topic, schema->second);
  return true;
}

void Mcap::repair(const std::string& kind, const std::string& detail) {
  if (repairs_) repairs_->add("bag: " + kind, name_ + ": " + detail);
}

}  // namespace edged

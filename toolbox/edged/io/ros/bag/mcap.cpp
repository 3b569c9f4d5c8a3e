// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads the records of an MCAP file.
#include "edged/io/ros/bag/mcap.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "edged/io/archive/compression.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/io/ros/bag/mcap_format.hpp"

namespace edged {
namespace {

constexpr std::uint64_t kMagicBytes = kMcapMagic.size();
constexpr std::uint64_t kRecordHead = 9;             // opcode and length
constexpr std::uint64_t kLargestRecord = 1U << 30U;  // longer ones are damage

std::string_view mcap_text(ByteReader& reader) { return reader.text(reader.number<std::uint32_t>()); }

Timestamp mcap_time(ByteReader& reader) {
  const auto ns = reader.number<std::uint64_t>();
  if (ns > static_cast<std::uint64_t>(kMaxStampNs)) throw Damage("stamp out of range");
  return timestamp_from_ns(static_cast<std::int64_t>(ns));
}

}  // namespace

Mcap::Mcap(const std::filesystem::path& path, Repairs* repairs) : RecordSource(path, kMagicBytes, repairs) {
  find_topics();
}

/// Schemas, channels and counts lie between the end of the data and the footer, which has a fixed size.
void Mcap::read_index() {
  constexpr std::uint64_t kFooterBytes = kRecordHead + 20;
  if (file().size() < kFooterBytes + 2 * kMagicBytes) throw Damage("no footer");
  const std::uint64_t end = file().size() - kMagicBytes - kFooterBytes;
  const Bytes tail = file().read(end, kFooterBytes);
  ByteReader footer(tail);
  if (footer.number<std::uint8_t>() != kMcapFooter || footer.number<std::uint64_t>() != 20) throw Damage("no footer");
  const auto begin = footer.number<std::uint64_t>();
  if (begin < kMagicBytes || begin >= end || end - begin > kLargestRecord) throw Damage("no summary");

  bool counted = false;
  const Bytes summary = file().read(begin, static_cast<std::size_t>(end - begin));
  for (ByteReader records(summary); records.left() > 0;) {
    const auto op = records.number<std::uint8_t>();
    ByteReader record(records.take(records.number<std::uint64_t>()));
    if (take_description(op, record)) continue;
    if (op == kMcapStatistics) {
      take_statistics(record);
      counted = true;
    } else if (op == kMcapChunkIndex) {
      take_chunk_index(record);
    }
  }
  if (!counted) throw Damage("no counts");
}

void Mcap::take_statistics(ByteReader& record) {
  record.take(8 + 2 + 4 + 4 + 4 + 4);  // counts of messages, schemas, channels, attachments, metadata, chunks
  extend(mcap_time(record));
  extend(mcap_time(record));
  for (auto left = record.number<std::uint32_t>() / 10; left > 0; --left) {
    const auto channel = topic_of_channel_.find(record.number<std::uint16_t>());
    const auto count = record.number<std::uint64_t>();
    if (channel != topic_of_channel_.end()) count_messages(channel->second, count);
  }
}

void Mcap::take_chunk_index(ByteReader& record) {
  record.take(8 + 8);  // first and last time
  const auto place = record.number<std::uint64_t>();
  record.take(8);  // length of the chunk
  std::vector<std::size_t> topics;
  for (auto left = record.number<std::uint32_t>() / 10; left > 0; --left) {
    const auto channel = topic_of_channel_.find(record.number<std::uint16_t>());
    record.take(8);                                                       // offsets of its message indices
    if (channel == topic_of_channel_.end()) return add_chunk(place, {});  // the channel may be described later
    topics.push_back(channel->second);
  }
  add_chunk(place, std::move(topics));
}

void Mcap::forget() {
  schemas_.clear();
  topic_of_channel_.clear();
}

/// Loads the records of a chunk, or a record outside chunks, for reading.
bool Mcap::load_record() {
  const std::uint64_t begin = at();
  const Bytes head = file().read(begin, kRecordHead);
  ByteReader fields(head);
  const auto op = fields.number<std::uint8_t>();
  const auto size = fields.number<std::uint64_t>();
  if (op == kMcapDataEnd || op == kMcapFooter) {
    go_to(file().size());
    return false;
  }
  if (size > kLargestRecord) throw Damage("record too long");
  go_to(begin + kRecordHead + size);
  if (op > kMcapChunk || (op == kMcapChunk && !is_of_use(begin))) return false;
  if (at() > file().size()) repair("cut", "the file ends within a record");
  Bytes record = file().read(begin, static_cast<std::size_t>(kRecordHead + size));
  if (op == kMcapChunk) {
    load_chunk(ByteReader(ByteSpan(record).subspan(kRecordHead)));
  } else {
    load(std::move(record));
  }
  return true;
}

void Mcap::load_chunk(ByteReader chunk) {
  chunk.take(8 + 8);  // first and last time
  const auto unpacked_size = chunk.number<std::uint64_t>();
  chunk.take(4);  // checksum: optional, and damage of a chunk is detected without it
  const std::string_view method = mcap_text(chunk);
  const auto packed_size = chunk.number<std::uint64_t>();
  if (unpacked_size > kLargestRecord) throw Damage("chunk too long");
  const auto there = static_cast<std::size_t>(std::min<std::uint64_t>(packed_size, chunk.left()));
  Decompressed records = decompress(method, chunk.take(there), static_cast<std::size_t>(unpacked_size));
  if ((!records.whole || records.bytes.size() != unpacked_size) && at() <= file().size())
    repair("chunk damaged", fmt::format("chunk before byte {} is not whole", at()));
  load(std::move(records.bytes));
}

std::optional<Message> Mcap::take_message() {
  const auto op = reader().number<std::uint8_t>();
  ByteReader record(reader().take(reader().number<std::uint64_t>()));
  if (take_description(op, record) || op != kMcapMessage) return std::nullopt;
  const auto channel = topic_of_channel_.find(record.number<std::uint16_t>());
  record.take(4);  // sequence
  const Timestamp t = mcap_time(record);
  record.take(8);                                               // time of publication
  if (channel == topic_of_channel_.end()) return std::nullopt;  // of no known type
  extend(t);
  return Message{channel->second, record.take(record.left())};
}

/// Schemas name types, channels topics; false for other records.
bool Mcap::take_description(std::uint8_t op, ByteReader& record) {
  if (op == kMcapSchema) {
    const auto id = record.number<std::uint16_t>();
    const std::string_view type = mcap_text(record), encoding = mcap_text(record);
    schemas_[id] = {std::string(type), encoding.starts_with("ros") ? std::string(mcap_text(record)) : ""};
    return true;
  }
  if (op != kMcapChannel) return false;
  const auto id = record.number<std::uint16_t>();
  const auto schema = schemas_.find(record.number<std::uint16_t>());
  const std::string_view topic = mcap_text(record), encoding = mcap_text(record);
  if (schema == schemas_.end() || topic_of_channel_.contains(id)) return true;
  const auto& [type, definition] = schema->second;
  if (encoding == "ros1") wire_ = Wire::Ros1;
  const bool ros = encoding == "cdr" || encoding == "ros1";
  topic_of_channel_[id] = describe_topic(topic, ros ? type : fmt::format("{} in {}", type, encoding), definition);
  return true;
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/ros/bag/message_records.hpp"

#include <zlib.h>

#include <algorithm>

#include "edged/core/check.hpp"

namespace edged {

void RecordSource::find_topics() {
  bool indexed = true;
  try {
    read_index();
  } catch (const Damage&) {
    indexed = false;
  }
  if (!indexed || topics_.empty()) read_through();
  if (topics_.empty()) throw InputError::format("{}: no messages in this bag: record it again", name_);
}

Bytes RecordSource::index_at(std::uint64_t begin, std::uint64_t end) {
  if (begin < first_record() || begin >= end || end - begin > kLargestRecord) throw Damage("no index");
  return file().read(begin, static_cast<std::size_t>(end - begin));
}

void RecordSource::take_index(ByteSpan index) {
  for (ByteReader records(index); records.left() > 0;) take_record(records);
}

void RecordSource::read_through() {
  topics_.clear();
  index_.clear();
  first_ = Timestamp::max(), last_ = Timestamp::min();
  forget();
  repair("no index",
         "its index is missing or damaged (a recorder that crashed?): reading all of it to find its topics");
  while (const auto message = next()) ++topics_[message->topic].count;
  repairs_ = nullptr;  // the next pass meets the same damage, which is already counted
  rewind();
  load({});
}

std::optional<Message> RecordSource::read(std::optional<std::size_t> only) {
  while (reader_.left() > 0 || load_next_record(only)) {
    try {
      const auto message = take_record(reader_);
      if (!message || (only && message->topic != *only)) continue;
      ++read_[message->topic];
      return message;
    } catch (const Damage& damage) {
      repair("chunk damaged", fmt::format("chunk before byte {}: {}", at(), damage.what()));
      load({});
    }
  }
  if (!only && !std::exchange(compared_, true)) compare_counts();
  return std::nullopt;
}

/// Shows what no check of a record has found.
void RecordSource::compare_counts() {
  for (std::size_t i = 0; i < topics_.size(); ++i)
    if (const Topic& topic = topics_[i]; topic.count > read_[i])
      repair("message missing", fmt::format("{}: {} of {} messages", topic.name, read_[i], topic.count),
             topic.count - read_[i]);
}

bool RecordSource::load_next_record(std::optional<std::size_t> only) {
  load({});  // one chunk at a time is in memory
  while (const auto place = next_place()) {
    if (place->end() > file().size()) repair("cut", "the file ends within a record");
    if (place->kind == kSkipped || (only && place->kind == kChunk && !may_hold(*place, *only))) continue;
    try {
      Bytes record = bytes_of(*place);
      load(place->kind == kChunk ? unpack(*place, record) : std::move(record));
      return true;
    } catch (const Damage& damage) {
      repair("record damaged", fmt::format("byte {}: {}", place->begin, damage.what()));
    }
  }
  return false;
}

/// False for a chunk that has no message of the topic by the index.
bool RecordSource::may_hold(const RecordPlace& chunk, std::size_t topic) const {
  const auto found = index_.find(chunk.begin);
  return found == index_.end() || found->second.empty() ||
         std::ranges::find(found->second, topic) != found->second.end();
}

Bytes RecordSource::unpack(const RecordPlace& chunk, ByteSpan record) {
  const PackedChunk parts = open_chunk(ByteReader(record));
  if (parts.bytes > kLargestRecord) throw Damage("chunk too long");
  if (!parts.sound) repair("record damaged", fmt::format("byte {}: opcode or length of a chunk", chunk.begin));
  Decompressed records = decompress(parts.compression, parts.packed, static_cast<std::size_t>(parts.bytes));
  if (chunk.end() > file().size()) return std::move(records.bytes);
  if (!records.whole || records.bytes.size() != parts.bytes)
    repair("chunk damaged", fmt::format("chunk at byte {} is not whole", chunk.begin));
  else if (parts.checksum != 0 && crc32_z(0, records.bytes.data(), records.bytes.size()) != parts.checksum)
    throw Damage("the checksum of the chunk differs");
  return std::move(records.bytes);
}

void RecordSource::load(Bytes records) {
  records_ = std::move(records);
  reader_ = ByteReader(records_);
}

void RecordSource::count_damage(std::uint64_t at, const std::string& reason, std::optional<std::uint64_t> /*next*/) {
  repair("record damaged", fmt::format("byte {}: {}", at, reason));
}

void RecordSource::extend(Timestamp t) {
  first_ = std::min(first_, t);
  last_ = std::max(last_, t);
}

void RecordSource::repair(const std::string& kind, const std::string& detail, std::size_t count) {
  if (repairs_) repairs_->add("bag: " + kind, name_ + ": " + detail, count);
}

void RecordWriter::write(std::size_t topic, Timestamp t, std::string_view message) {
  TopicRecords& records = topics_[topic];
  if (!std::exchange(records.written, true)) records_ += records.schema + records.channel;
  index_[topic].push_back({t, records_.size()});
  records_ += message_record(topic, t, message);
  ++records.messages;
  if (records_.size() >= options_.bytes) close_chunk();
}

void RecordWriter::close_chunk() {
  if (index_.empty()) return;
  const std::string packed = compress(options_.compression, records_);
  ChunkInfo chunk{.place = file_.size(), .packed = packed.size(), .unpacked = records_.size()};
  for (const auto& [topic, entries] : index_)
    for (const IndexEntry& entry : entries) {
      chunk.begin = std::min(chunk.begin, entry.t);
      chunk.end = std::max(chunk.end, entry.t);
    }
  file_.write(chunk_record(chunk, packed));
  chunk.bytes = file_.size() - chunk.place;
  for (const auto& [topic, entries] : index_) {
    chunk.topics[topic] = {file_.size(), entries.size()};
    file_.write(index_record(topic, entries));
  }
  chunk.index_bytes = file_.size() - chunk.place - chunk.bytes;
  chunks_.push_back(std::move(chunk));
  records_.clear();
  index_.clear();
}

void RecordWriter::finish() {
  close_chunk();
  write_summary();
  file_.flush();
}

}  // namespace edged

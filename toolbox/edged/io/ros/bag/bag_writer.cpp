// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The records of a bag, with the index that ROS tools require.
#include "edged/io/ros/bag/bag_writer.hpp"

#include <algorithm>
#include <utility>

#include "edged/io/archive/compression.hpp"
#include "edged/io/ros/bag/bag_format.hpp"

namespace edged {
namespace {

constexpr std::size_t kBagHeadBytes = 4096;  // of the first record, padded

std::uint64_t bag_time(Timestamp t) {
  // For tools, the time zero means that it is not set.
  const auto ns = static_cast<std::uint64_t>(std::max<std::int64_t>(to_ns(t), 1));
  return ns / 1'000'000'000 | (ns % 1'000'000'000) << 32U;
}

/// `name=value` pairs, each with its length.
class BagHeader {
 public:
  explicit BagHeader(std::uint8_t op) { field("op", op); }
  BagHeader() = default;

  template <typename T>
  BagHeader& field(std::string_view name, T value) {
    begin_field(name, sizeof(T));
    append_number(fields_, value);
    return *this;
  }
  BagHeader& text(std::string_view name, std::string_view value) {
    begin_field(name, value.size());
    fields_ += value;
    return *this;
  }
  const std::string& bytes() const { return fields_; }

 private:
  void begin_field(std::string_view name, std::size_t value_bytes) {
    append_number(fields_, static_cast<std::uint32_t>(name.size() + 1 + value_bytes));
    fields_ += name;
    fields_ += "=";
  }
  std::string fields_;
};

void put_sized(std::string& out, std::string_view bytes) {
  append_number(out, static_cast<std::uint32_t>(bytes.size()));
  out += bytes;
}

std::string bag_record(const BagHeader& header, std::string_view data) {
  std::string record;
  put_sized(record, header.bytes());
  put_sized(record, data);
  return record;
}

}  // namespace

BagWriter::BagWriter(const std::filesystem::path& file, const ChunkOptions& options) : file_(file), options_(options) {
  file_.write(kBagMagic);
  write_head(0);
}

/// Without index_place, while the bag is unfinished, the header states that there is no index.
void BagWriter::write_head(std::uint64_t index_place) {
  BagHeader header(kBagHeader);
  header.field("index_pos", index_place)
      .field("conn_count", static_cast<std::uint32_t>(connections_.size()))
      .field("chunk_count", static_cast<std::uint32_t>(chunks_.size()));
  const std::string padding(kBagHeadBytes - 8 - header.bytes().size(), ' ');
  const std::string record = bag_record(header, padding);
  if (index_place == 0) return file_.write(record);
  file_.overwrite(kBagMagic.size(), record);
}

std::size_t BagWriter::add_topic(std::string_view name, std::string_view type, const MessageDefinition& definition) {
  const auto id = static_cast<std::uint32_t>(connections_.size());
  const BagHeader header = BagHeader(kBagConnection).field("conn", id).text("topic", name);
  const BagHeader data = BagHeader()
                             .text("topic", name)
                             .text("type", type)
                             .text("md5sum", definition.md5)
                             .text("message_definition", definition.text);
  connections_.push_back({bag_record(header, data.bytes())});
  return id;
}

void BagWriter::write(std::size_t topic, Timestamp t, std::string_view message) {
  if (!std::exchange(connections_[topic].written, true)) chunk_ += connections_[topic].record;
  const auto id = static_cast<std::uint32_t>(topic);
  index_[id].push_back({t, static_cast<std::uint32_t>(chunk_.size())});
  chunk_ += bag_record(BagHeader(kBagMessage).field("conn", id).field("time", bag_time(t)), message);
  if (chunk_.size() >= options_.bytes) close_chunk();
}

void BagWriter::close_chunk() {
  if (index_.empty()) return;
  ChunkInfo info{file_.size(), Timestamp::max(), Timestamp::min(), {}};
  const BagHeader header = BagHeader(kBagChunk)
                               .text("compression", options_.compression)
                               .field("size", static_cast<std::uint32_t>(chunk_.size()));
  file_.write(bag_record(header, compress(options_.compression, chunk_)));
  for (const auto& [connection, entries] : index_) {
    const auto count = static_cast<std::uint32_t>(entries.size());
    std::string data;
    for (const IndexEntry& entry : entries) {
      info.begin = std::min(info.begin, entry.t);
      info.end = std::max(info.end, entry.t);
      append_number(data, bag_time(entry.t));
      append_number(data, entry.offset);
    }
    info.counts[connection] = count;
    const BagHeader index =
        BagHeader(kBagIndex).field("ver", std::uint32_t{1}).field("conn", connection).field("count", count);
    file_.write(bag_record(index, data));
  }
  chunks_.push_back(std::move(info));
  chunk_.clear();
  index_.clear();
}

void BagWriter::finish() {
  close_chunk();
  const std::uint64_t index_place = file_.size();
  for (const Connection& connection : connections_) file_.write(connection.record);
  for (const ChunkInfo& chunk : chunks_) {
    const BagHeader header = BagHeader(kBagChunkInfo)
                                 .field("ver", std::uint32_t{1})
                                 .field("chunk_pos", chunk.place)
                                 .field("start_time", bag_time(chunk.begin))
                                 .field("end_time", bag_time(chunk.end))
                                 .field("count", static_cast<std::uint32_t>(chunk.counts.size()));
    std::string data;
    for (const auto& [connection, count] : chunk.counts) {
      append_number(data, connection);
      append_number(data, count);
    }
    file_.write(bag_record(header, data));
  }
  write_head(index_place);
  file_.flush();
}

}  // namespace edged

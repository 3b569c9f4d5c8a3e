// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The records of an MCAP file, with a summary as index.
#include "edged/io/ros/bag/mcap_writer.hpp"

#include <algorithm>
#include <utility>

#include "edged/io/ros/bag/mcap_format.hpp"

namespace edged {
namespace {

void put_text(std::string& out, std::string_view text) {
  append_number(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

std::string mcap_record(McapOp op, const std::string& content) {
  std::string record;
  append_number<std::uint8_t>(record, op);
  append_number<std::uint64_t>(record, content.size());
  record += content;
  return record;
}

std::uint64_t mcap_stamp(Timestamp t) { return static_cast<std::uint64_t>(std::max<std::int64_t>(to_ns(t), 0)); }

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& file, std::string_view profile, const ChunkOptions& options)
    : file_(file), options_(options) {
  file_.write(kMcapMagic);
  std::string header;
  put_text(header, profile);
  put_text(header, "edged");
  file_.write(mcap_record(kMcapHeader, header));
}

std::size_t McapWriter::add_topic(const McapTopic& topic) {
  const auto id = static_cast<std::uint16_t>(channels_.size());
  std::string schema, channel;
  append_number<std::uint16_t>(schema, id + 1);  // zero: no schema
  put_text(schema, topic.type);
  put_text(schema, topic.type_encoding);
  put_text(schema, topic.type_text);
  append_number(channel, id);
  append_number<std::uint16_t>(channel, id + 1);
  put_text(channel, topic.name);
  put_text(channel, topic.encoding);
  append_number<std::uint32_t>(channel, 0);  // no further properties
  channels_.push_back({mcap_record(kMcapSchema, schema), mcap_record(kMcapChannel, channel)});
  return id;
}

void McapWriter::write(std::size_t topic, Timestamp t, std::string_view message) {
  Channel& channel = channels_[topic];
  const auto id = static_cast<std::uint16_t>(topic);
  if (!std::exchange(channel.written, true)) {
    chunk_ += channel.schema;
    chunk_ += channel.channel;
  }
  index_[id].push_back({mcap_stamp(t), chunk_.size()});
  std::string content;
  append_number(content, id);
  append_number(content, static_cast<std::uint32_t>(channel.messages++));
  append_number(content, mcap_stamp(t));  // recorded
  append_number(content, mcap_stamp(t));  // published
  content += message;
  chunk_ += mcap_record(kMcapMessage, content);
  if (chunk_.size() >= options_.bytes) close_chunk();
}

void McapWriter::write_metadata(std::string_view name, const std::map<std::string, std::string>& values) {
  std::string pairs, content, index;
  for (const auto& [key, value] : values) put_text(pairs, key), put_text(pairs, value);
  put_text(content, name);
  put_text(content, pairs);
  const std::string record = mcap_record(kMcapMetadata, content);
  append_number(index, file_.size());
  append_number<std::uint64_t>(index, record.size());
  put_text(index, name);
  metadata_index_.push_back(mcap_record(kMcapMetadataIndex, index));
  file_.write(record);
}

void McapWriter::close_chunk() {
  if (index_.empty()) return;
  ChunkInfo info = write_chunk();
  const std::uint64_t index_begin = file_.size();
  for (const auto& [channel, entries] : index_) {
    info.index_places[channel] = file_.size();
    std::string content;
    append_number(content, channel);
    append_number(content, static_cast<std::uint32_t>(16 * entries.size()));
    for (const IndexEntry& entry : entries) {
      append_number(content, entry.t);
      append_number(content, entry.offset);
    }
    file_.write(mcap_record(kMcapMessageIndex, content));
  }
  info.index_bytes = file_.size() - index_begin;
  chunks_.push_back(std::move(info));
  chunk_.clear();
  index_.clear();
}

McapWriter::ChunkInfo McapWriter::write_chunk() {
  ChunkInfo info{UINT64_MAX, 0, file_.size(), 0, {}, 0, 0, chunk_.size()};
  for (const auto& [channel, entries] : index_) {
    for (const IndexEntry& entry : entries) {
      info.begin = std::min(info.begin, entry.t);
      info.end = std::max(info.end, entry.t);
    }
  }
  const std::string packed = compress(options_.compression, chunk_);
  info.packed = packed.size();
  std::string content;
  append_number(content, info.begin);
  append_number(content, info.end);
  append_number(content, info.unpacked);
  append_number<std::uint32_t>(content, 0);  // no checksum, as the compression has one
  put_text(content, options_.compression);
  append_number(content, info.packed);
  content += packed;
  file_.write(mcap_record(kMcapChunk, content));
  info.bytes = file_.size() - info.place;
  return info;
}

std::string McapWriter::statistics() const {
  std::uint64_t messages = 0, begin = UINT64_MAX, end = 0;
  for (const Channel& channel : channels_) messages += channel.messages;
  for (const ChunkInfo& chunk : chunks_) begin = std::min(begin, chunk.begin), end = std::max(end, chunk.end);
  std::string content;
  append_number(content, messages);
  append_number(content, static_cast<std::uint16_t>(channels_.size()));  // schemas
  append_number(content, static_cast<std::uint32_t>(channels_.size()));
  append_number<std::uint32_t>(content, 0);  // attachments
  append_number(content, static_cast<std::uint32_t>(metadata_index_.size()));
  append_number(content, static_cast<std::uint32_t>(chunks_.size()));
  append_number(content, chunks_.empty() ? 0 : begin);
  append_number(content, end);
  append_number(content, static_cast<std::uint32_t>(10 * channels_.size()));
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    append_number(content, static_cast<std::uint16_t>(i));
    append_number(content, channels_[i].messages);
  }
  return mcap_record(kMcapStatistics, content);
}

std::string McapWriter::chunk_index(const ChunkInfo& chunk) const {
  std::string content;
  append_number(content, chunk.begin);
  append_number(content, chunk.end);
  append_number(content, chunk.place);
  append_number(content, chunk.bytes);
  append_number(content, static_cast<std::uint32_t>(10 * chunk.index_places.size()));
  for (const auto& [channel, place] : chunk.index_places) {
    append_number(content, channel);
    append_number(content, place);
  }
  append_number(content, chunk.index_bytes);
  put_text(content, options_.compression);
  append_number(content, chunk.packed);
  append_number(content, chunk.unpacked);
  return mcap_record(kMcapChunkIndex, content);
}

void McapWriter::finish() {
  close_chunk();
  std::string data_end;
  append_number<std::uint32_t>(data_end, 0);  // no checksum
  file_.write(mcap_record(kMcapDataEnd, data_end));
  const std::uint64_t summary = file_.size();
  for (const Channel& channel : channels_) file_.write(channel.schema);
  for (const Channel& channel : channels_) file_.write(channel.channel);
  file_.write(statistics());
  for (const ChunkInfo& chunk : chunks_) file_.write(chunk_index(chunk));
  for (const std::string& record : metadata_index_) file_.write(record);
  std::string footer;
  append_number(footer, summary);
  append_number<std::uint64_t>(footer, 0);  // no list of the parts of the summary
  append_number<std::uint32_t>(footer, 0);  // no checksum
  file_.write(mcap_record(kMcapFooter, footer));
  file_.write(kMcapMagic);
  file_.flush();
}

}  // namespace edged

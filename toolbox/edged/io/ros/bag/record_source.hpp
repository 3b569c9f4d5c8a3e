// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The common part of ROS 1 bags and MCAP files.
#pragma once

#include <map>
#include <utility>

#include "edged/io/parse/repairs.hpp"
#include "edged/io/ros/bag/message_source.hpp"

namespace edged {

/// A file of records, most of them in chunks that may be compressed. An index at the end holds topics and counts. If
/// it is missing or damaged, as after a crash of the recorder, the whole file is read once.
class RecordSource : public MessageSource {
 public:
  const std::vector<Topic>& topics() const final { return topics_; }
  Duration length() const final { return last_ > first_ ? last_ - first_ : Duration(0); }
  std::optional<Timestamp> begin_stamp() const final { return last_ >= first_ ? std::optional(first_) : std::nullopt; }
  std::optional<Message> next() final;
  std::optional<Message> next_of(std::size_t topic) final;

 protected:
  /// first_record: its offset, after the magic bytes.
  RecordSource(const std::filesystem::path& file, std::uint64_t first_record, Repairs* repairs);

  /// Reads topics, counts and times. To be called last in a constructor. Throws InputError without messages.
  void find_topics();

  // The part of each format. Each function may throw Damage.

  /// Describes topics and chunks from the index.
  virtual void read_index() = 0;
  /// Discards the descriptions from the records so far.
  virtual void forget() = 0;
  /// Skips the record of the file at at(). False: it has no message for take_message().
  virtual bool load_record() = 0;
  /// Takes the next record in memory. Nothing if it is no message.
  virtual std::optional<Message> take_message() = 0;

  BinaryFile& file() { return file_; }
  std::uint64_t at() const { return at_; }
  void go_to(std::uint64_t place) { at_ = place; }
  /// Sets the records for take_message(), which reads them from reader().
  void load(Bytes records);
  ByteReader& reader() { return reader_; }
  /// Index of the topic with that name and type.
  std::size_t describe_topic(std::string_view name, std::string_view type, std::string_view definition);
  void count_messages(std::size_t topic, std::size_t count) { topics_[topic].count += count; }
  /// topics: those of its messages, empty if the index does not list them.
  void add_chunk(std::uint64_t place, std::vector<std::size_t> topics) { chunks_[place] = std::move(topics); }
  /// False for a chunk without a message of the topic `sought_`.
  bool is_of_use(std::uint64_t chunk) const;
  void extend(Timestamp t);
  void repair(const std::string& kind, const std::string& detail);

 private:
  void read_through();
  void rewind();
  bool load_next_record();

  std::string name_;
  BinaryFile file_;
  std::uint64_t first_record_;
  Repairs* repairs_;
  std::vector<Topic> topics_;
  /// Chunks of the index by their offset, with their topics. Reading continues there after damage.
  std::map<std::uint64_t, std::vector<std::size_t>> chunks_;
  std::optional<std::size_t> sought_;  ///< the only topic that is read at present
  Timestamp first_ = Timestamp::max(), last_ = Timestamp::min();
  std::uint64_t at_ = 0;  ///< offset of the next record of the file
  Bytes records_;         ///< the records being read
  ByteReader reader_{ByteSpan()};
};

}  // namespace edged

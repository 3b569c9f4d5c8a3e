// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What ROS 1 bags and MCAP files have in common.
#pragma once

#include <map>
#include <utility>

#include "edged/io/repairs.hpp"
#include "edged/io/ros/message_source.hpp"

namespace edged {

/// A file of records, most of them in chunks that may be compressed. An index at the end tells topics and counts; where
/// it is missing or damaged (a recorder that crashed), the file is read through once.
class RecordSource : public MessageSource {
 public:
  const std::vector<Topic>& topics() const final { return topics_; }
  Duration length() const final { return last_ > first_ ? last_ - first_ : Duration(0); }
  std::optional<Timestamp> begin_stamp() const final { return last_ >= first_ ? std::optional(first_) : std::nullopt; }
  std::optional<Message> next() final;
  std::optional<Message> next_of(std::size_t topic) final;

 protected:
  /// first_record: its offset, behind the magic bytes.
  RecordSource(const std::filesystem::path& file, std::uint64_t first_record, Repairs* repairs);

  /// Topics, counts and times, for the end of a constructor. Throws InputError when there is nothing to read.
  void find_topics();

  // What a format has of its own. Each may throw Damage.

  /// Describes topics and chunks from the index.
  virtual void read_index() = 0;
  /// Forgets what the records described so far.
  virtual void forget() = 0;
  /// Steps over the record of the file at at(). False: nothing in it is for take_message().
  virtual bool load_record() = 0;
  /// The next record in memory, if it is a message.
  virtual std::optional<Message> take_message() = 0;

  BinaryFile& file() { return file_; }
  std::uint64_t at() const { return at_; }
  void go_to(std::uint64_t place) { at_ = place; }
  /// Records for take_message(), which takes them off reader().
  void load(Bytes records);
  ByteReader& reader() { return reader_; }
  /// Index of the topic with that name and type.
  std::size_t describe_topic(std::string_view name, std::string_view type, std::string_view definition);
  void count_messages(std::size_t topic, std::size_t count) { topics_[topic].count += count; }
  /// topics: of its messages; empty where the index does not tell.
  void add_chunk(std::uint64_t place, std::vector<std::size_t> topics) { chunks_[place] = std::move(topics); }
  /// False: a chunk without a message of the topic that is looked for.
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
  /// Of the index, by their place: where reading goes on after damage, and which topics are in each.
  std::map<std::uint64_t, std::vector<std::size_t>> chunks_;
  std::optional<std::size_t> sought_;  ///< the only topic that is of use, at present
  Timestamp first_ = Timestamp::max(), last_ = Timestamp::min();
  std::uint64_t at_ = 0;  ///< next record of the file
  Bytes records_;         ///< those being read
  ByteReader reader_{ByteSpan()};
};

}  // namespace edged

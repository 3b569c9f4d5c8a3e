// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads the records of a file, and skips damaged ones.
#include "edged/io/ros/bag/record_source.hpp"

#include <algorithm>

#include "edged/core/check.hpp"

namespace edged {

RecordSource::RecordSource(const std::filesystem::path& file, std::uint64_t first_record, Repairs* repairs)
    : name_(file.string()), file_(file), first_record_(first_record), repairs_(repairs), at_(first_record) {}

void RecordSource::find_topics() {
  bool indexed = true;
  try {
    read_index();
  } catch (const Damage&) {
    indexed = false;
  }
  rewind();
  if (!indexed || topics_.empty()) read_through();
  if (topics_.empty()) throw InputError::format("{}: no messages in this bag: record it again", name_);
}

void RecordSource::read_through() {
  topics_.clear();
  chunks_.clear();
  first_ = Timestamp::max(), last_ = Timestamp::min();
  forget();
  repair("no index",
         "its index is missing or damaged (a recorder that crashed?): reading all of it to find its topics");
  while (const auto message = next()) ++topics_[message->topic].count;
  repairs_ = nullptr;  // the next pass meets the same damage, which is already counted
  rewind();
}

void RecordSource::rewind() {
  at_ = first_record_;
  load({});
}

std::optional<Message> RecordSource::next() {
  while (reader_.left() > 0 || load_next_record()) {
    try {
      if (auto message = take_message()) return message;
    } catch (const Damage& damage) {
      repair("chunk damaged", fmt::format("chunk before byte {}: {}", at_, damage.what()));
      load({});
    }
  }
  return std::nullopt;
}

std::optional<Message> RecordSource::next_of(std::size_t topic) {
  sought_ = topic;
  std::optional<Message> message = MessageSource::next_of(topic);
  sought_.reset();
  return message;
}

bool RecordSource::is_of_use(std::uint64_t chunk) const {
  const auto found = chunks_.find(chunk);
  if (!sought_ || found == chunks_.end() || found->second.empty()) return true;
  return std::ranges::find(found->second, *sought_) != found->second.end();
}

bool RecordSource::load_next_record() {
  while (at_ < file_.size()) {
    const std::uint64_t begin = at_;
    try {
      if (load_record()) return true;
    } catch (const Damage& damage) {
      repair("record damaged", fmt::format("byte {}: {}", begin, damage.what()));
      const auto next_chunk = chunks_.upper_bound(begin);
      at_ = next_chunk == chunks_.end() ? file_.size() : next_chunk->first;
      load({});
    }
  }
  return false;
}

void RecordSource::load(Bytes records) {
  records_ = std::move(records);
  reader_ = ByteReader(records_);
}

std::size_t RecordSource::describe_topic(std::string_view name, std::string_view type, std::string_view definition) {
  return topic_index(topics_, name, type, definition);
}

void RecordSource::extend(Timestamp t) {
  first_ = std::min(first_, t);
  last_ = std::max(last_, t);
}

void RecordSource::repair(const std::string& kind, const std::string& detail) {
  if (repairs_) repairs_->add("bag: " + kind, name_ + ": " + detail);
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Walks a file of records one after the other, as of a bag, MCAP or AEDAT4, and finds the way back after damage.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/archive/bytes.hpp"

namespace edged {

/// Where a record lies in its file, and what it is.
struct RecordPlace {
  std::uint64_t begin = 0;  ///< offset of its head
  std::uint64_t data = 0;   ///< offset of its data, after the head
  std::uint64_t bytes = 0;  ///< length of the data, which may extend beyond the end of a cut file
  std::uint32_t kind = 0;   ///< a number of the format
  bool closed = false;      ///< its content confirms its length: no other record lies within
  std::uint64_t end() const { return data + bytes; }
};

/// The records of a file, in order. A format derives from this class and describes the heads of its records.
class RecordFile {
 public:
  virtual ~RecordFile() = default;

 protected:
  RecordFile(BinaryFile file, std::uint64_t first_record)
      : file_(std::move(file)), first_record_(first_record), end_(file_.size()) {
    rewind();
  }

  /// The record at an offset. Throws Damage for a head that no record has.
  virtual RecordPlace locate(std::uint64_t at) = 0;
  /// True for bytes that begin a record which is recognised anywhere in the file, also within damage.
  virtual bool begins_record(ByteSpan bytes) const = 0;
  /// Called for a record that cannot be located. Reading continues at `next`, if anywhere.
  virtual void count_damage(std::uint64_t at, const std::string& reason, std::optional<std::uint64_t> next) = 0;

  /// The next record that can be located, and that does not cover one of the index. After damage, that is the first one
  /// of the index behind the last good one, whose length may be wrong; without an index, the first one that is found.
  std::optional<RecordPlace> next_place();
  bool record_begins(std::uint64_t at) { return begins_record(file_.read(at, kLookAhead)); }
  void rewind() { at_ = good_ = searched_to_ = first_record_; }

  BinaryFile& file() { return file_; }
  Bytes bytes_of(const RecordPlace& place) {
    return file_.read(place.begin, static_cast<std::size_t>(place.end() - place.begin));
  }
  /// Offset of the next record.
  std::uint64_t at() const { return at_; }
  std::uint64_t first_record() const { return first_record_; }
  std::uint64_t end() const { return end_; }
  /// Sets the end of the records, before the end of the file.
  void set_end(std::uint64_t end) { end_ = end; }

  /// Records that the index lists by their offset, each with the numbers of its topics; none if it does not list them.
  std::map<std::uint64_t, std::vector<std::size_t>> index_;

 private:
  static constexpr std::size_t kLookAhead = 256;  ///< bytes by which begins_record() decides

  RecordPlace checked_place();
  bool can_be_located(std::uint64_t at);
  std::optional<std::uint64_t> search(std::uint64_t from);
  bool resynchronize(const std::string& reason);

  BinaryFile file_;
  std::uint64_t first_record_, end_;
  std::uint64_t at_ = 0, good_ = 0;  ///< offset of the next record, and of the last good one or its end
  std::uint64_t searched_to_ = 0;    ///< search() begins here at the earliest
};

/// Bytes after their length of 32 bits, as in bags and MCAP.
inline ByteSpan take_sized(ByteReader& reader) { return reader.take(reader.number<std::uint32_t>()); }
inline std::string_view take_text(ByteReader& reader) { return as_text(take_sized(reader)); }
inline void append_sized(std::string& out, std::string_view bytes) {
  append_number(out, static_cast<std::uint32_t>(bytes.size()));
  out += bytes;
}

}  // namespace edged

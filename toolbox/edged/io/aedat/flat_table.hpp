// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads FlatBuffers without generated code. Each access is checked to lie within the buffer.
#pragma once

#include <optional>

#include "edged/io/archive/bytes.hpp"

namespace edged {

/// A number at `offset`. Throws Damage beyond the end.
template <typename T>
T number_at(ByteSpan bytes, std::size_t offset) {
  if (offset > bytes.size() || bytes.size() - offset < sizeof(T)) throw Damage("points beyond its end");
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// A vector: `count` items from offset `at` on.
struct FlatVector {
  std::size_t at = 0, count = 0;
};

/// A table of a buffer. Fields are numbered from 0 in the order of the schema. Absent fields have their default value.
class FlatTable {
 public:
  /// The root table of a buffer.
  explicit FlatTable(ByteSpan buffer) : FlatTable(buffer, number_at<std::uint32_t>(buffer, 0)) {}

  template <typename T>
  T number(unsigned field, T otherwise = 0) const {
    const std::size_t at = place(field);
    return at ? number_at<T>(buffer_, at) : otherwise;
  }

  /// item_bytes: 1 for strings, 4 for tables. An absent vector is empty.
  FlatVector vector(unsigned field, std::size_t item_bytes) const {
    const std::size_t at = place(field);
    if (!at) return {};
    const std::size_t begin = at + number_at<std::uint32_t>(buffer_, at);
    const std::size_t count = number_at<std::uint32_t>(buffer_, begin);
    if (count > (buffer_.size() - begin - 4) / item_bytes) throw Damage("a list goes beyond its end");
    return {begin + 4, count};
  }

  ByteSpan bytes(unsigned field) const {
    const FlatVector list = vector(field, 1);
    return buffer_.subspan(list.at, list.count);
  }

  /// The table that item `index` of a vector of tables points to.
  FlatTable table(const FlatVector& list, std::size_t index) const {
    const std::size_t at = list.at + 4 * index;
    return {buffer_, at + number_at<std::uint32_t>(buffer_, at)};
  }

 private:
  FlatTable(ByteSpan buffer, std::size_t at) : buffer_(buffer), at_(at) {
    // The signed distance backwards from the table. As an unsigned offset, a wrong one lies beyond the buffer.
    const auto back = number_at<std::int32_t>(buffer_, at_);
    layout_ = at_ - static_cast<std::size_t>(static_cast<std::int64_t>(back));
    layout_bytes_ = number_at<std::uint16_t>(buffer_, layout_);
  }

  /// Offset of a field; 0 for an absent one.
  std::size_t place(unsigned field) const {
    const std::size_t entry = 4 + 2 * std::size_t{field};
    if (entry + 2 > layout_bytes_) return 0;
    const auto offset = number_at<std::uint16_t>(buffer_, layout_ + entry);
    return offset ? at_ + offset : 0;
  }

  ByteSpan buffer_;
  std::size_t at_;            ///< offset of the table
  std::size_t layout_;        ///< offset of the list of the offsets of its fields
  std::size_t layout_bytes_;  ///< length of that list
};

/// The type of a buffer: the four characters after the offset of the root table.
inline std::string_view flat_identifier(ByteSpan buffer) {
  if (buffer.size() < 8) throw Damage("ends too early");
  return as_text(buffer.subspan(4, 4));
}

/// A buffer after its length. Throws Damage if it is not of this type.
inline ByteSpan flat_buffer(ByteSpan bytes, std::string_view type) {
  ByteReader reader(bytes);
  const ByteSpan buffer = reader.take(reader.number<std::uint32_t>());
  if (flat_identifier(buffer) != type) throw Damage("is not of the type of its stream");
  return buffer;
}

}  // namespace edged

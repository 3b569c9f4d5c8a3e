// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reading large text files in bounded memory, and numbers and stamps without rounding.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/archive/source_path.hpp"
#include "edged/io/time_unit.hpp"
#include "edged/time.hpp"

namespace edged {

/// The texts of the elements of a range, for fmt::join. std::views would do, but clang 14 cannot compile them.
template <class Range, class Text>
std::vector<std::string> texts_of(const Range& range, Text text) {
  std::vector<std::string> texts;
  for (const auto& element : range) texts.emplace_back(std::invoke(text, element));
  return texts;
}

/// A file as blocks of complete lines, without a byte order mark, and with points for decimal commas between
/// semicolons. Throws InputError if it is not readable or not text (no line end in a block).
class BlockReader {
 public:
  explicit BlockReader(const SourcePath& file, std::size_t block_bytes = 256 * 1024);

  /// The next block, which ends with '\n'; empty at the end of the file. Valid until the next call.
  std::string_view next();

  /// True if the file ends without '\n', known after the last block. One is added to that block.
  bool unterminated() const { return unterminated_; }

  /// The damage that ended the file early, as in a damaged archive; "" without damage.
  const std::string& damage() const { return damage_; }

 private:
  void fill();
  void begin_text();

  std::string name_;
  std::unique_ptr<ByteSource> source_;
  std::string damage_;
  std::vector<char> buffer_;
  std::size_t filled_ = 0;  ///< bytes in buffer_
  std::size_t given_ = 0;   ///< bytes already returned
  bool at_end_ = false;
  bool unterminated_ = false;
  bool begun_ = false;
  bool decimal_commas_ = false;
};

struct TextLine {
  std::string_view text;   ///< without the line end; valid until the next call
  std::size_t number = 0;  ///< from 1
  bool terminated = true;  ///< false: the last line of a file that does not end with '\n'
};

/// A file line by line, without empty lines and those that start with '#'.
class LineReader {
 public:
  explicit LineReader(const SourcePath& file) : blocks_(file, 64 * 1024) {}
  std::optional<TextLine> next();
  /// See BlockReader::damage().
  const std::string& damage() const { return blocks_.damage(); }

 private:
  BlockReader blocks_;
  std::string_view block_;
  std::size_t number_ = 0;
};

/// True for a line of words instead of numbers: the column names of a csv.
bool is_heading(std::string_view line);

/// The names in a heading, separated by commas or semicolons, else by blanks. After a blank, a unit in brackets belongs
/// to the name before it.
std::vector<std::string> heading_fields(std::string_view line);

/// Converts ASCII letters to lower case.
std::string lower_case(std::string_view text);

/// Fields of a line, separated by blanks, tabs, carriage returns or single commas or semicolons.
class FieldReader {
 public:
  explicit FieldReader(std::string_view line) : rest_(line) {}
  /// The next field; empty at the end.
  std::string_view next();
  /// The rest of the line, trimmed.
  std::string_view rest() const;

 private:
  std::string_view rest_;
};

/// Stamps beyond this are refused as damage (in Unix time: after 2115), so that differences never overflow.
inline constexpr std::int64_t kMaxStampNs = 4'600'000'000'000'000'000;

/// The finite number in a field. Nothing if the field contains anything else.
std::optional<double> parse_number(std::string_view field);

/// The integer in a field. Nothing if the field contains anything else, or if it is out of range.
template <typename T>
std::optional<T> parse_whole(std::string_view field) {
  T value{};
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error == std::errc() && end == field.data() + field.size() ? std::optional(value) : std::nullopt;
}

/// Parses "s", "ms", "us" or "ns". Nothing for any other text.
std::optional<TimeUnit> parse_time_unit(std::string_view text);
/// The inverse of parse_time_unit().
const char* unit_name(TimeUnit unit);

/// A decimal number in that unit, also with an exponent, exact to the nanosecond (further digits are rounded half up).
/// Nothing if it is no number or out of range.
std::optional<Timestamp> parse_stamp(std::string_view field, TimeUnit unit);

/// Parses an integer number of nanoseconds.
std::optional<Timestamp> parse_nanoseconds(std::string_view field);

/// Writes a stamp in seconds with nine decimals.
std::string format_seconds(Timestamp t);

/// The stamp of the last complete line in which `parse` finds one, read from the end of the file. Nothing if there is
/// none, or for a packed file, which can only be read sequentially.
std::optional<Timestamp> last_stamp(const SourcePath& file,
                                    const std::function<std::optional<Timestamp>(std::string_view line)>& parse);

}  // namespace edged

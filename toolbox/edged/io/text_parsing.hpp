// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reading large text files in bounded memory, and numbers and stamps without rounding.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/source_path.hpp"
#include "edged/io/time_unit.hpp"
#include "edged/time.hpp"

namespace edged {

/// A file as blocks of whole lines. Throws InputError when it cannot be read or is not text (no line end in a block).
class BlockReader {
 public:
  explicit BlockReader(const SourcePath& file, std::size_t block_bytes = 256 * 1024);

  /// The next block, which ends with '\n'; empty at the end of the file. Valid until the next call.
  std::string_view next();

  /// True once the file turned out to end without '\n' (one is added to the last block).
  bool unterminated() const { return unterminated_; }

  /// What ended the file before its end (a damaged archive); "" where nothing did.
  const std::string& damage() const { return damage_; }

 private:
  void fill();

  std::string name_;
  std::unique_ptr<ByteSource> source_;
  std::string damage_;
  std::vector<char> buffer_;
  std::size_t filled_ = 0;  ///< bytes in buffer_
  std::size_t given_ = 0;   ///< of those, the ones already handed out
  bool at_end_ = false;
  bool unterminated_ = false;
};

struct TextLine {
  std::string_view text;   ///< without its end; valid until the next call
  std::size_t number = 0;  ///< from 1
  bool terminated = true;  ///< false: the last line of a file that does not end with '\n'
};

/// A file line by line; blank lines and those that start with '#' are left out.
class LineReader {
 public:
  explicit LineReader(const SourcePath& file) : blocks_(file, 64 * 1024) {}
  std::optional<TextLine> next();
  /// As of BlockReader.
  const std::string& damage() const { return blocks_.damage(); }

 private:
  BlockReader blocks_;
  std::string_view block_;
  std::size_t number_ = 0;
};

/// Words where numbers are wanted: the names of the columns of a csv.
bool is_heading(std::string_view line);

/// The names in a heading: separated by commas or semicolons, else by blanks, where a unit in brackets belongs to the
/// name before.
std::vector<std::string> heading_fields(std::string_view line);

/// ASCII letters as small ones.
std::string lower_case(std::string_view text);

/// Fields of a line, separated by blanks, tabs, carriage returns or single commas or semicolons.
class FieldReader {
 public:
  explicit FieldReader(std::string_view line) : rest_(line) {}
  /// The next field; empty when there is none.
  std::string_view next();
  /// All that is left, trimmed.
  std::string_view rest() const;

 private:
  std::string_view rest_;
};

/// Stamps beyond this are refused as damage (in Unix time: after 2115), so that differences never overflow.
inline constexpr std::int64_t kMaxStampNs = 4'600'000'000'000'000'000;

/// A finite number that fills the whole field, or nothing.
std::optional<double> parse_number(std::string_view field);

/// The next N fields as finite numbers; false when one is missing or is none.
template <std::size_t N>
bool read_numbers(FieldReader& fields, std::array<double, N>& numbers) {
  for (double& x : numbers) {
    const auto number = parse_number(fields.next());
    if (!number) return false;
    x = *number;
  }
  return true;
}

/// "s", "ms", "us" or "ns"; nothing for any other text.
std::optional<TimeUnit> parse_time_unit(std::string_view text);
/// The name that parse_time_unit reads.
const char* unit_name(TimeUnit unit);

/// A decimal number of that unit, with exponent if any, exact to the nanosecond (rounded half up beyond). Nothing when
/// it is not a number or does not fit.
std::optional<Timestamp> parse_stamp(std::string_view field, TimeUnit unit);

inline std::optional<Timestamp> parse_seconds(std::string_view field) { return parse_stamp(field, TimeUnit::Seconds); }
inline std::optional<Timestamp> parse_microseconds(std::string_view field) {
  return parse_stamp(field, TimeUnit::Microseconds);
}

/// Whole nanoseconds.
std::optional<Timestamp> parse_nanoseconds(std::string_view field);

/// Seconds with all nine decimals.
std::string format_seconds(Timestamp t);

/// Stamp of the last complete line that `parse` finds one in, read from the end of the file; nothing when there is
/// none, or where it is packed and has no end that could be read alone.
std::optional<Timestamp> last_stamp(const SourcePath& file,
                                    const std::function<std::optional<Timestamp>(std::string_view line)>& parse);

}  // namespace edged

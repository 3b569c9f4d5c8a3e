// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Tables in text files: which column holds what and in which unit, by a heading or by convention. Readers and writers
// of all text formats share this description.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/archive/source_path.hpp"
#include "edged/io/parse/text_parsing.hpp"

namespace edged {

/// A column name as words in lower case, and the unit in its brackets: "w_RS_S_x [rad s^-1]" is w, rs, s, x in
/// "rads^-1".
struct ColumnName {
  std::string text;
  std::vector<std::string> words;
  std::string unit;
};

ColumnName column_name(std::string_view text);

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words);
bool has_word(const ColumnName& name, std::initializer_list<std::string_view> words);
/// "t", "timestamp", "header.stamp".
bool names_time(const ColumnName& name);
/// The unit by brackets or a word: "t [us]", "timestamp_ns".
std::optional<TimeUnit> time_unit_of(const ColumnName& name);
/// The axis: the last word that is a letter of "xyzw", or one of these stems with such a letter at its end: "qx".
std::optional<std::size_t> axis_of(const ColumnName& name, std::initializer_list<std::string_view> stems);

/// What the columns of one kind of table mean.
struct TableKind {
  std::vector<std::string_view> roles;                                      ///< the first is the time
  std::optional<std::size_t> (*role_of)(const ColumnName& name) = nullptr;  ///< index of `roles`
  std::string_view wanted;                                                  ///< an example of a heading, for messages
};

/// The columns that a line of a file names.
struct Heading {
  std::vector<std::size_t> at;    ///< column of each role in a line
  std::vector<ColumnName> names;  ///< names of all columns
  std::size_t line = 0;           ///< number of the line, from 1
  std::size_t count = 0;          ///< columns in a data line
  const ColumnName& name_of(std::size_t role) const { return names[at[role]]; }
  std::optional<TimeUnit> time_unit() const { return time_unit_of(name_of(0)); }
};

/// The heading above the data, also in a comment. Nothing if no line names the columns. Throws InputError, with the
/// unknown names, for a heading that does not name each role once.
std::optional<Heading> find_heading(const SourcePath& file, const TableKind& kind);

/// The names in the last line above the data; empty without such a line.
std::vector<ColumnName> last_heading(const SourcePath& file);

/// A line above the data.
struct HeadingLine {
  std::string text;  ///< without the comment marks
  std::size_t number = 0;
  bool comment = false;
};

/// The beginning of a file: the lines above the data, and the first line of data; all empty without data.
struct FileHead {
  std::vector<HeadingLine> lines;
  std::string data;
};

FileHead read_head(const SourcePath& file);

/// Where a line has its columns, and in which units.
struct TextTable {
  std::vector<std::size_t> at = {};   ///< column of each role, from 0; the first is the time
  TimeUnit unit = TimeUnit::Seconds;  ///< unit of the stamps
  std::vector<double> scales = {};    ///< factors to SI units of the roles after the time; empty: 1
  bool exact = false;                 ///< lines have no further columns
  bool named = false;                 ///< by a heading
  bool guessed = false;               ///< a column or unit is not named, but found from the content
  std::string said = {};              ///< for the user: columns, units, and how they were found
  std::string doubt = {};             ///< what contradicts that; "" for nothing
};

/// The columns and the unit that the heading of the file names, else those given.
TextTable heading_or(const SourcePath& file, const TableKind& kind, TextTable otherwise);

/// Reads the lines of a table.
class RowReader {
 public:
  explicit RowReader(const TextTable& table);

  /// The stamp of a line, and its numbers in SI units by role, as many as there are roles after the time. Nothing if
  /// the line does not fit or holds anything but finite numbers.
  std::optional<Timestamp> read(std::string_view line, std::span<double> numbers) const;

 private:
  TextTable table_;
  std::vector<std::optional<std::size_t>> role_at_;  ///< by column
};

/// A line of the table without its end: the stamp, in seconds with nine decimals or in nanoseconds, and the numbers by
/// role, which read back to the same bits.
std::string format_row(const TextTable& table, Timestamp t, std::span<const double> numbers, char separator);

/// The numbers of the first lines of data; NaN for any other text.
struct RowSample {
  std::vector<std::vector<double>> rows;
  std::size_t line = 0;  ///< number of the first row's line, from 1
  bool commas = false;   ///< the first row has some
};

/// At most so many lines, those without `needed` columns that hold numbers left out.
RowSample sample_rows(const SourcePath& file, std::size_t most, const std::vector<std::size_t>& needed);

/// The median of the absolute differences of the stamps in column `t`; nothing for less than two rows.
std::optional<double> median_step(const RowSample& sample, std::size_t t);

inline constexpr std::array kTimeUnits = {TimeUnit::Seconds, TimeUnit::Milliseconds, TimeUnit::Microseconds,
                                          TimeUnit::Nanoseconds};
double seconds_of(TimeUnit unit);

}  // namespace edged

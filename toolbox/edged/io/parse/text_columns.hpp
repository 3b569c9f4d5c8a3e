// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Finds the columns of a text file by the names in its heading. Internal to io.
#pragma once

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

/// The columns of one kind of file.
struct ColumnRoles {
  std::vector<std::string_view> roles;                                      ///< the first is the time
  std::optional<std::size_t> (*role_of)(const ColumnName& name) = nullptr;  ///< index of `roles`
  std::string_view wanted;                                                  ///< an example of a heading, for messages
};

struct NamedColumns {
  std::vector<std::size_t> at;    ///< column of each role in a line
  std::vector<ColumnName> names;  ///< of all columns
  std::size_t line = 0;           ///< of the heading, from 1
  std::size_t count = 0;          ///< columns in a data line
  const ColumnName& name_of(std::size_t role) const { return names[at[role]]; }
};

/// The columns that a line above the data names, also a comment. Nothing if no line does. Throws InputError, with the
/// unknown names, for a heading that does not name each role once.
std::optional<NamedColumns> named_columns(const SourcePath& file, const ColumnRoles& roles);

/// The names in the last line above the data; empty without such a line.
std::vector<ColumnName> last_heading(const SourcePath& file);

/// Selects the fields with a role from a line.
class ColumnPicker {
 public:
  /// exact: a line has no columns after the last of `at`.
  explicit ColumnPicker(const std::vector<std::size_t>& at, bool exact = false);

  /// The fields by role, as many as `at` has. False if the line does not fit.
  bool pick(std::string_view line, std::span<std::string_view> fields) const;

 private:
  std::vector<std::optional<std::size_t>> role_at_;  ///< by column
  bool exact_;
};

}  // namespace edged

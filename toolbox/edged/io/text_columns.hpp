// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The columns of a text file by the names in its heading. Internal to io.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/source_path.hpp"
#include "edged/io/text_parsing.hpp"

namespace edged {

/// A name as words in small letters, and what its brackets hold: "w_RS_S_x [rad s^-1]" is w, rs, s, x in "rads^-1".
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
/// By brackets or a word: "t [us]", "timestamp_ns".
std::optional<TimeUnit> time_unit_of(const ColumnName& name);
/// The last word that is one letter out of "xyzw", or a stem of these with such a letter at its end: "qx".
std::optional<std::size_t> axis_of(const ColumnName& name, std::initializer_list<std::string_view> stems);

/// What the columns of one kind of file are.
struct ColumnRoles {
  std::vector<std::string_view> roles;                                      ///< the first is the time
  std::optional<std::size_t> (*role_of)(const ColumnName& name) = nullptr;  ///< index of `roles`
  std::string_view wanted;                                                  ///< a heading, for messages
};

struct NamedColumns {
  std::vector<std::size_t> at;    ///< place of each role in a line
  std::vector<ColumnName> names;  ///< of all places
  std::size_t line = 0;           ///< of the heading, from 1
  std::size_t count = 0;          ///< of columns in a line of data
  const ColumnName& name_of(std::size_t role) const { return names[at[role]]; }
};

/// The columns that a line above the data names, also in a comment. Nothing where no line does. Throws InputError, with
/// the names that are not known, where one is a heading but does not name each role once.
std::optional<NamedColumns> named_columns(const SourcePath& file, const ColumnRoles& roles);

/// The names in the last line above the data; empty where there is none.
std::vector<ColumnName> last_heading(const SourcePath& file);

/// Takes the fields with a role out of a line.
class ColumnPicker {
 public:
  /// exact: a line has no further columns than those up to the last of `at`.
  explicit ColumnPicker(const std::vector<std::size_t>& at, bool exact = false);

  /// By role, as many as `at` has. False where the line does not fit.
  bool pick(std::string_view line, std::span<std::string_view> fields) const;

 private:
  std::vector<std::optional<std::size_t>> role_at_;  ///< by place
  bool exact_;
};

}  // namespace edged

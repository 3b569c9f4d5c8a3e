// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Parses the headings of text files.
#include "edged/io/parse/text_columns.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "edged/core/check.hpp"

namespace edged {
namespace {

/// A line above the data.
struct HeadingLine {
  std::string text;  ///< without the comment marks
  std::size_t number = 0;
  bool comment = false;
};

/// The lines above the data, and the number of fields of a data line.
struct FileHead {
  std::vector<HeadingLine> lines;
  std::size_t columns = 0;
};

std::size_t count_fields(std::string_view line) {
  std::size_t count = 0;
  for (FieldReader fields(line); !fields.rest().empty(); ++count) fields.next();
  return count;
}

/// A data line begins or ends with a number: in a list of images the stamps may follow the names.
bool holds_data(std::string_view line) {
  const std::size_t last = line.find_last_of(" \t,;") + 1;
  return parse_number(FieldReader(line).next()) ||
         (line.find_first_of("#%") != 0 && last > 0 && parse_number(line.substr(last)));
}

FileHead read_head(const SourcePath& file) {
  constexpr std::size_t kMostLines = 100;
  FileHead head;
  BlockReader blocks(file, 64 * 1024);
  std::string_view block = blocks.next();
  std::size_t number = 0;
  for (std::size_t end; number < kMostLines && (end = block.find('\n')) != std::string_view::npos;
       block.remove_prefix(end + 1)) {
    const std::string_view line = FieldReader(block.substr(0, end)).rest();
    ++number;
    if (line.empty()) continue;
    if (holds_data(line)) {
      head.columns = count_fields(line);
      return head;
    }
    const std::size_t begin = line.find_first_not_of("#% \t");
    if (begin != std::string_view::npos) head.lines.push_back({std::string(line.substr(begin)), number, begin > 0});
  }
  return {};
}

/// The columns that a line names.
struct Naming {
  NamedColumns columns;
  std::vector<std::string_view> missing, repeated;
  std::vector<std::string> unknown;
  bool complete() const { return missing.empty() && repeated.empty(); }
};

Naming names_in(const HeadingLine& line, const ColumnRoles& roles) {
  Naming naming;
  naming.columns.line = line.number;
  std::vector<std::optional<std::size_t>> at(roles.roles.size());
  for (const std::string& field : heading_fields(line.text)) {
    const std::size_t place = naming.columns.names.size();
    naming.columns.names.push_back(column_name(field));
    const ColumnName& name = naming.columns.names.back();
    const auto role = roles.role_of(name);
    if (!role) {
      naming.unknown.push_back(name.text);
    } else if (!at[*role]) {
      at[*role] = place;
    } else if (*role > 0) {
      naming.repeated.push_back(roles.roles[*role]);
    } else if (has_word(name, {"header"})) {  // rostopic writes the time of arrival first, then that of the message
      at[0] = place;
    }
  }
  for (std::size_t role = 0; role < at.size(); ++role) {
    if (!at[role]) naming.missing.push_back(roles.roles[role]);
    naming.columns.at.push_back(at[role].value_or(0));
  }
  return naming;
}

std::string what_is_wrong(const Naming& naming) {
  std::string text;
  if (!naming.missing.empty()) text = fmt::format("no column is called {}", fmt::join(naming.missing, ", "));
  if (!naming.repeated.empty())
    text += fmt::format("{}two columns are called {}", text.empty() ? "" : ", ", fmt::join(naming.repeated, ", "));
  if (!naming.unknown.empty()) text += fmt::format("; not known: `{}`", fmt::join(naming.unknown, "`, `"));
  return text;
}

}  // namespace

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

ColumnName column_name(std::string_view text) {
  ColumnName out{std::string(FieldReader(text).rest()), {}, {}};
  std::string word;
  bool bracket = false;
  const auto end_word = [&] {
    if (!word.empty()) out.words.push_back(std::exchange(word, ""));
  };
  for (const char c : lower_case(text)) {
    if (c == '[' || c == '(') {
      bracket = true;
    } else if (c == ']' || c == ')') {
      bracket = false;
    } else if (bracket) {
      if (c != ' ') out.unit += c;
    } else if (std::isalnum(static_cast<unsigned char>(c))) {
      word += c;
    } else {
      end_word();
    }
  }
  end_word();
  return out;
}

bool has_word(const ColumnName& name, std::initializer_list<std::string_view> words) {
  return std::ranges::any_of(name.words, [&words](const std::string& word) { return is_one_of(word, words); });
}

bool names_time(const ColumnName& name) {
  return has_word(name, {"t", "ts", "time", "timestamp", "timestamps", "stamp", "stamps"}) &&
         !has_word(name, {"x", "y", "z", "w", "bias", "offset", "seq"});
}

std::optional<TimeUnit> time_unit_of(const ColumnName& name) {
  if (const auto unit = parse_time_unit(name.unit)) return unit;
  for (const std::string& word : name.words) {
    if (const auto unit = parse_time_unit(word)) return unit;
    if (is_one_of(word, {"sec", "secs", "seconds"})) return TimeUnit::Seconds;
    if (is_one_of(word, {"msec", "milliseconds"})) return TimeUnit::Milliseconds;
    if (is_one_of(word, {"usec", "microseconds"})) return TimeUnit::Microseconds;
    if (is_one_of(word, {"nsec", "nanosec", "nanoseconds"})) return TimeUnit::Nanoseconds;
  }
  return std::nullopt;
}

std::optional<std::size_t> axis_of(const ColumnName& name, std::initializer_list<std::string_view> stems) {
  constexpr std::string_view kAxes = "xyzw";
  for (auto word = name.words.rbegin(); word != name.words.rend(); ++word) {
    const std::size_t axis = kAxes.find(word->back());
    if (axis == std::string_view::npos) continue;
    if (word->size() == 1 || is_one_of(std::string_view(*word).substr(0, word->size() - 1), stems)) return axis;
  }
  return std::nullopt;
}

std::optional<NamedColumns> named_columns(const SourcePath& file, const ColumnRoles& roles) {
  const FileHead head = read_head(file);
  std::optional<Naming> incomplete;
  for (auto line = head.lines.rbegin(); line != head.lines.rend(); ++line) {
    Naming naming = names_in(*line, roles);
    const std::size_t names = naming.columns.names.size();
    if (names > head.columns) continue;
    naming.columns.count = head.columns;
    if (naming.complete()) return std::move(naming.columns);
    const bool names_nothing = naming.missing.size() == roles.roles.size();
    if (names != head.columns || incomplete) continue;
    if (!names_nothing || !line->comment)
      incomplete = std::move(naming);
    else
      spdlog::warn(fmt::format("{}:{}: `{}` names no column that is known: read as a comment", file.string(),
                               line->number, line->text));
  }
  if (incomplete)
    throw InputError::format("{}:{}: {}; name the columns as in `{}`", file.string(), incomplete->columns.line,
                             what_is_wrong(*incomplete), roles.wanted);
  return std::nullopt;
}

std::vector<ColumnName> last_heading(const SourcePath& file) {
  const FileHead head = read_head(file);
  std::vector<ColumnName> names;
  if (!head.lines.empty())
    for (const std::string& field : heading_fields(head.lines.back().text)) names.push_back(column_name(field));
  return names;
}

ColumnPicker::ColumnPicker(const std::vector<std::size_t>& at, bool exact) : exact_(exact) {
  role_at_.resize(1 + std::ranges::max(at));
  for (std::size_t role = 0; role < at.size(); ++role) role_at_[at[role]] = role;
}

bool ColumnPicker::pick(std::string_view line, std::span<std::string_view> fields) const {
  FieldReader reader(line);
  for (const auto& role : role_at_) {
    if (reader.rest().empty()) return false;
    const std::string_view field = reader.next();
    if (role) fields[*role] = field;
  }
  return !exact_ || reader.rest().empty();
}

}  // namespace edged

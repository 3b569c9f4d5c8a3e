// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/parse/text_table.hpp"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "edged/core/check.hpp"
#include "edged/core/statistics.hpp"

namespace edged {
namespace {

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

/// The columns that a line names.
struct Naming {
  Heading heading;
  std::vector<std::string_view> missing, repeated;
  std::vector<std::string> unknown;
  bool complete() const { return missing.empty() && repeated.empty(); }
};

Naming names_in(const HeadingLine& line, const TableKind& kind) {
  Naming naming;
  naming.heading.line = line.number;
  std::vector<std::optional<std::size_t>> at(kind.roles.size());
  for (const std::string& field : heading_fields(line.text)) {
    const std::size_t place = naming.heading.names.size();
    naming.heading.names.push_back(column_name(field));
    const ColumnName& name = naming.heading.names.back();
    const auto role = kind.role_of(name);
    if (!role) {
      naming.unknown.push_back(name.text);
    } else if (!at[*role]) {
      at[*role] = place;
    } else if (*role > 0) {
      naming.repeated.push_back(kind.roles[*role]);
    } else if (has_word(name, {"header"})) {  // rostopic writes the time of arrival first, then that of the message
      at[0] = place;
    }
  }
  for (std::size_t role = 0; role < at.size(); ++role) {
    if (!at[role]) naming.missing.push_back(kind.roles[role]);
    naming.heading.at.push_back(at[role].value_or(0));
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
  static const std::map<std::string_view, TimeUnit> words = {{"sec", TimeUnit::Seconds},
                                                             {"secs", TimeUnit::Seconds},
                                                             {"seconds", TimeUnit::Seconds},
                                                             {"msec", TimeUnit::Milliseconds},
                                                             {"milliseconds", TimeUnit::Milliseconds},
                                                             {"usec", TimeUnit::Microseconds},
                                                             {"microseconds", TimeUnit::Microseconds},
                                                             {"nsec", TimeUnit::Nanoseconds},
                                                             {"nanosec", TimeUnit::Nanoseconds},
                                                             {"nanoseconds", TimeUnit::Nanoseconds}};
  if (const auto unit = parse_time_unit(name.unit)) return unit;
  for (const std::string& word : name.words) {
    if (const auto unit = parse_time_unit(word)) return unit;
    if (const auto known = words.find(word); known != words.end()) return known->second;
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
      head.data = line;
      return head;
    }
    const std::size_t begin = line.find_first_not_of("#% \t");
    if (begin != std::string_view::npos) head.lines.push_back({std::string(line.substr(begin)), number, begin > 0});
  }
  return {};
}

std::optional<Heading> find_heading(const SourcePath& file, const TableKind& kind) {
  const FileHead head = read_head(file);
  const std::size_t columns = count_fields(head.data);
  std::optional<Naming> incomplete;
  for (auto line = head.lines.rbegin(); line != head.lines.rend(); ++line) {
    Naming naming = names_in(*line, kind);
    const std::size_t names = naming.heading.names.size();
    if (names > columns) continue;
    naming.heading.count = columns;
    if (naming.complete()) return std::move(naming.heading);
    const bool names_nothing = naming.missing.size() == kind.roles.size();
    if (names != columns || incomplete) continue;
    if (!names_nothing || !line->comment)
      incomplete = std::move(naming);
    else
      spdlog::warn(fmt::format("{}:{}: `{}` names no column that is known: read as a comment", file.string(),
                               line->number, line->text));
  }
  if (incomplete)
    throw InputError::format("{}:{}: {}; name the columns as in `{}`", file.string(), incomplete->heading.line,
                             what_is_wrong(*incomplete), kind.wanted);
  return std::nullopt;
}

std::vector<ColumnName> last_heading(const SourcePath& file) {
  const FileHead head = read_head(file);
  std::vector<ColumnName> names;
  if (!head.lines.empty())
    for (const std::string& field : heading_fields(head.lines.back().text)) names.push_back(column_name(field));
  return names;
}

TextTable heading_or(const SourcePath& file, const TableKind& kind, TextTable otherwise) {
  const auto heading = find_heading(file, kind);
  if (!heading) return otherwise;
  return {.at = heading->at,
          .unit = heading->time_unit().value_or(otherwise.unit),
          .named = true,
          .said = "a line with the columns that its heading names"};
}

RowReader::RowReader(const TextTable& table) : table_(table), role_at_(1 + std::ranges::max(table.at)) {
  for (std::size_t role = 0; role < table.at.size(); ++role) role_at_[table.at[role]] = role;
}

std::optional<Timestamp> RowReader::read(std::string_view line, std::span<double> numbers) const {
  std::optional<Timestamp> t;
  FieldReader fields(line);
  for (const auto& role : role_at_) {
    const std::string_view field = fields.next();
    if (!role) continue;
    if (*role == 0) {
      t = parse_stamp(field, table_.unit);
      if (!t) return std::nullopt;
    } else {
      const auto number = parse_number(field);
      if (!number) return std::nullopt;
      numbers[*role - 1] = table_.scales.empty() ? *number : table_.scales[*role - 1] * *number;
    }
  }
  return table_.exact && !fields.rest().empty() ? std::nullopt : t;
}

std::string format_row(const TextTable& table, Timestamp t, std::span<const double> numbers, char separator) {
  std::vector<std::string> fields(table.at.size());
  fields[table.at[0]] = table.unit == TimeUnit::Seconds ? format_seconds(t) : fmt::format("{}", to_ns(t));
  for (std::size_t i = 0; i < numbers.size(); ++i) fields[table.at[1 + i]] = fmt::format("{}", numbers[i]);
  return fmt::format("{}", fmt::join(fields, std::string_view(&separator, 1)));
}

RowSample sample_rows(const SourcePath& file, std::size_t most, const std::vector<std::size_t>& needed) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  RowSample sample;
  LineReader lines(file);
  for (std::size_t i = 0; i < most; ++i) {
    const auto line = lines.next();
    if (!line) break;
    std::vector<double> row;
    for (FieldReader fields(line->text); !fields.rest().empty();)
      row.push_back(parse_number(fields.next()).value_or(kNone));
    const auto holds = [&row](std::size_t column) { return column < row.size() && std::isfinite(row[column]); };
    if (!std::ranges::all_of(needed, holds)) continue;
    if (sample.rows.empty()) sample.line = line->number, sample.commas = line->text.find(',') != line->text.npos;
    if (sample.rows.empty() || row.size() == sample.rows[0].size()) sample.rows.push_back(std::move(row));
  }
  return sample;
}

std::optional<double> median_step(const RowSample& sample, std::size_t t) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < sample.rows.size(); ++i)
    steps.push_back(std::abs(sample.rows[i][t] - sample.rows[i - 1][t]));
  return steps.empty() ? std::nullopt : std::optional(median(std::move(steps)));
}

double seconds_of(TimeUnit unit) { return std::pow(10.0, static_cast<int>(unit) - 9); }

}  // namespace edged

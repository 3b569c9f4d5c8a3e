// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which columns a plain event file has, and in which unit its stamps are.
#include <algorithm>
#include <array>
#include <cmath>

#include "edged/core/check.hpp"
#include "edged/io/geometry.hpp"
#include "edged/io/text/event_csv.hpp"

namespace edged {
namespace {

constexpr std::size_t kMostRows = 4096;
constexpr std::size_t kMostHeaderLines = 100;

using Row = std::array<double, 4>;

struct ColumnName {
  std::string name;  ///< in small letters, without its unit
  std::optional<TimeUnit> unit;
};

/// Of "timestamp [us]", "t(s)", "\"ts_ns\"" or "x".
ColumnName column_name(std::string_view text) {
  ColumnName out;
  for (const char c : lower_case(text))
    if (c != '"' && c != '\'' && c != ' ' && c != '\t') out.name += c;
  const std::size_t cut = out.name.find_first_of("[(_");
  if (cut == std::string::npos || cut == 0) return out;
  std::string unit = out.name.substr(cut + 1);
  if (!unit.empty() && (unit.back() == ']' || unit.back() == ')')) unit.pop_back();
  out.unit = parse_time_unit(unit);
  out.name.resize(cut);
  return out;
}

/// The columns that a line names; nothing where it does not name all four once.
std::optional<EventTextForm> named_columns(std::string_view line) {
  line.remove_prefix(std::min(line.size(), line.find_first_not_of("#%/ \t")));
  const std::vector<std::string> fields = heading_fields(line.substr(0, line.find_last_not_of(" \t\r") + 1));
  if (fields.size() < 4 || fields.size() > EventColumns::kMost) return std::nullopt;
  constexpr std::string_view kNames[4] = {" t ts time timestamp timestamps stamp ", " x col column ", " y row ",
                                          " p pol polarity polarities on "};
  EventTextForm form;
  std::size_t* const places[4] = {&form.columns.t, &form.columns.x, &form.columns.y, &form.columns.p};
  std::array<int, 4> found{};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const ColumnName column = column_name(fields[i]);
    for (std::size_t k = 0; k < 4; ++k) {
      if (column.name.empty() || kNames[k].find(" " + column.name + " ") == std::string_view::npos) continue;
      ++found[k];
      *places[k] = i;
      if (k == 0 && column.unit) form.columns.unit = *column.unit, form.unit_known = true;
    }
  }
  form.columns.count = fields.size();
  return found == std::array<int, 4>{1, 1, 1, 1} ? std::optional(form) : std::nullopt;
}

/// The numbers of a line; nothing where it holds anything else.
std::optional<std::vector<double>> numbers_of(std::string_view line) {
  std::vector<double> numbers;
  for (FieldReader fields(line); !fields.rest().empty() && numbers.size() <= EventColumns::kMost;) {
    const auto number = parse_number(fields.next());
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

bool fits(const std::vector<Row>& rows, const EventColumns& order) {
  constexpr double kMostPixels = 16384;
  std::size_t backwards = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    for (const std::size_t pixel : {order.x, order.y})
      if (row[pixel] < 0 || row[pixel] >= kMostPixels || row[pixel] != std::floor(row[pixel])) return false;
    if (row[order.p] != 0 && std::abs(row[order.p]) != 1) return false;
    if (i > 0 && row[order.t] < rows[i - 1][order.t]) ++backwards;
  }
  constexpr std::size_t kOneInSoMany = 50;
  return backwards <= rows.size() / kOneInSoMany;
}

/// The orders that tools write, the most common first.
std::optional<EventColumns> columns_by_content(const std::vector<Row>& rows) {
  constexpr EventColumns kOrders[] = {{.t = 0, .x = 1, .y = 2, .p = 3},
                                      {.t = 3, .x = 0, .y = 1, .p = 2},
                                      {.t = 2, .x = 0, .y = 1, .p = 3},
                                      {.t = 0, .x = 2, .y = 3, .p = 1}};
  if (rows.empty()) return std::nullopt;
  for (const EventColumns& order : kOrders)
    if (fits(rows, order)) return order;
  return std::nullopt;
}

/// "# geometry 240x180".
std::optional<cv::Size> geometry_in_comment(std::string_view line) {
  constexpr std::string_view kKey = "geometry ";
  const std::size_t at = line.find(kKey);
  return at == std::string_view::npos ? std::nullopt
                                      : parse_geometry(FieldReader(line.substr(at + kKey.size())).next());
}

/// Reads lines until the form is known and the rows are enough.
class FormFinder {
 public:
  /// False once no further line is wanted, or the file is none of events.
  bool take(std::string_view line) {
    ++line_;
    if (line.find_first_not_of(" \t\r") == std::string_view::npos) return true;
    if (const auto numbers = numbers_of(line)) return take_row(line, *numbers);
    if (!raw_.empty()) return true;  // a damaged line
    if (const auto named = named_columns(line)) {
      const auto geometry = form_.geometry;
      form_ = *named, form_.geometry = geometry;
      named_ = true;
    }
    if (const auto size = geometry_in_comment(line)) form_.geometry = size;
    form_.columns.header_lines = line_;
    return line_ < kMostHeaderLines;
  }

  std::optional<EventTextForm> finish(const SourcePath& file) {
    if (raw_.empty()) return std::nullopt;
    if (!named_) {
      const auto columns = columns_by_content(rows_);
      if (!columns) return std::nullopt;
      const std::size_t header_lines = form_.columns.header_lines;
      form_.columns = *columns, form_.columns.header_lines = header_lines;
    }
    sample_stamps(file);
    return form_;
  }

 private:
  bool take_row(std::string_view line, const std::vector<double>& numbers) {
    if (raw_.empty() && !named_ && numbers.size() == 2) {  // the size of the sensor, as E2VID has it
      form_.geometry = parse_geometry(fmt::format("{}x{}", numbers[0], numbers[1]));
      form_.columns.header_lines = line_;
      return form_.geometry.has_value();
    }
    if (numbers.size() != (named_ ? form_.columns.count : 4)) return !raw_.empty();  // the first row decides
    if (!named_) rows_.push_back({numbers[0], numbers[1], numbers[2], numbers[3]});
    raw_.emplace_back(line);
    return raw_.size() < kMostRows;
  }

  void sample_stamps(const SourcePath& file) {
    StampSample& s = form_.stamps;
    const auto raw_stamp = [this](std::string_view line) -> std::optional<double> {
      const auto numbers = numbers_of(line);
      return numbers && numbers->size() == form_.columns.count ? std::optional((*numbers)[form_.columns.t])
                                                               : std::nullopt;
    };
    for (const std::string& line : raw_) {
      const auto stamp = raw_stamp(line);
      if (!stamp) continue;
      if (s.count++ == 0) s.first = *stamp;
      s.last = std::max(s.count == 1 ? *stamp : s.last, *stamp);
      s.fractions = s.fractions || *stamp != std::floor(*stamp);
    }
    s.end = s.last;
    last_stamp(file, [&](std::string_view line) -> std::optional<Timestamp> {
      const auto stamp = raw_stamp(line);
      if (stamp) s.end = std::max(s.end, *stamp);
      return stamp ? std::optional(Timestamp()) : std::nullopt;
    });
  }

  EventTextForm form_;
  bool named_ = false;
  std::size_t line_ = 0;
  std::vector<std::string> raw_;
  std::vector<Row> rows_;
};

bool is_text(std::string_view block) {
  return std::ranges::none_of(block, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 && c != '\t' && c != '\n' && c != '\r';
  });
}

}  // namespace

std::optional<TimeUnit> guess_time_unit(const StampSample& stamps) {
  constexpr double kHour = 3600, kDay = 24 * kHour;
  constexpr double kYear2000 = 946'684'800, kYear2100 = 4'102'444'800;  // [s] of Unix time
  struct Bounds {
    double min_rate_hz, max_rate_hz, min_s, max_s;
  };
  const auto plausible = [&](TimeUnit unit, const Bounds& b) {
    const double seconds = std::pow(10.0, static_cast<double>(unit) - 9);
    const double span = (stamps.last - stamps.first) * seconds, all = (stamps.end - stamps.first) * seconds;
    const double rate = static_cast<double>(stamps.count) / span, begin = stamps.first * seconds;
    const bool date = begin <= 30 * kDay || (begin >= kYear2000 && begin < kYear2100);  // since power-on, or of today
    return span > 0 && date && rate >= b.min_rate_hz && rate <= b.max_rate_hz && all >= b.min_s && all <= b.max_s;
  };
  if (stamps.fractions)
    return plausible(TimeUnit::Seconds, {1, 1e9, 0, kDay}) ? std::optional(TimeUnit::Seconds) : std::nullopt;
  std::optional<TimeUnit> only;
  for (const TimeUnit unit :
       {TimeUnit::Seconds, TimeUnit::Milliseconds, TimeUnit::Microseconds, TimeUnit::Nanoseconds}) {
    if (!plausible(unit, {3e3, 5e7, 0.1, kHour})) continue;
    if (only) return std::nullopt;
    only = unit;
  }
  return only;
}

std::optional<EventTextForm> find_event_form(const SourcePath& file) try {
  BlockReader blocks(file);
  std::string_view block = blocks.next();
  if (!is_text(block)) return std::nullopt;
  FormFinder finder;
  while (!block.empty()) {
    const std::size_t end = block.find('\n');
    if (!finder.take(block.substr(0, end))) break;
    block.remove_prefix(end + 1);
  }
  return finder.finish(file);
} catch (const InputError&) {
  return std::nullopt;  // no text
}

}  // namespace edged

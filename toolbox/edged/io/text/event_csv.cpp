// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Detects the columns of a plain event file and the unit of its stamps, opens it, and writes one.
#include "edged/io/text/event_text.hpp"

#include <spdlog/fmt/compile.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>

#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"
#include "edged/io/parse/text_table.hpp"
#include "edged/io/text/text_dataset.hpp"

namespace edged {
namespace {

constexpr std::size_t kMostRows = 4096;
constexpr std::size_t kMostHeaderLines = 100;

using Row = std::vector<double>;

/// 0: time, 1: x, 2: y, 3: polarity.
std::optional<std::size_t> event_role(const ColumnName& column) {
  if (has_word(column, {"p", "pol", "polarity", "polarities", "on"})) return 3;
  if (names_time(column)) return 0;
  std::vector<std::string> words = column.words;
  std::erase_if(words, [](const std::string& word) {
    return is_one_of(word, {"event", "pixel", "px", "coord", "coordinate", "addr", "address", "pos"});
  });
  if (words.size() != 1) return std::nullopt;
  if (is_one_of(words[0], {"x", "col", "column"})) return 1;
  return is_one_of(words[0], {"y", "row"}) ? std::optional<std::size_t>(2) : std::nullopt;
}

/// The columns of the heading. Nothing if no line names all columns.
std::optional<EventTextForm> form_by_heading(const SourcePath& file) {
  static const TableKind kind{{"t", "x", "y", "p"}, event_role, "t[s],x,y,p"};
  const auto heading = find_heading(file, kind);
  if (!heading || heading->count > EventColumns::kMost) return std::nullopt;
  const std::vector<std::size_t>& at = heading->at;
  const auto unit = heading->time_unit();
  EventTextForm form;
  form.columns = {.t = at[0],
                  .x = at[1],
                  .y = at[2],
                  .p = at[3],
                  .count = heading->count,
                  .unit = unit.value_or(TimeUnit::Seconds),
                  .header_lines = heading->line};
  form.unit_known = unit.has_value();
  return form;
}

/// The numbers of a line. Nothing if it holds anything else.
std::optional<Row> numbers_of(std::string_view line) {
  Row numbers;
  for (FieldReader fields(line); !fields.rest().empty() && numbers.size() <= EventColumns::kMost;) {
    const std::string_view field = fields.next();
    const auto number = parse_number(field), polarity = number ? number : parse_polarity(field);
    if (!polarity) return std::nullopt;
    numbers.push_back(*polarity);
  }
  return numbers;
}

bool fits(const std::vector<Row>& rows, const EventColumns& order) {
  constexpr double kWidestSensor = 16384;
  std::size_t backwards = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    for (const std::size_t pixel : {order.x, order.y})
      if (row[pixel] < 0 || row[pixel] >= kWidestSensor || row[pixel] != std::floor(row[pixel])) return false;
    if (row[order.p] != 0 && std::abs(row[order.p]) != 1) return false;
    if (i > 0 && row[order.t] < rows[i - 1][order.t]) ++backwards;
  }
  constexpr std::size_t kOneInSoMany = 50;
  return backwards <= rows.size() / kOneInSoMany;
}

/// The orders of columns that tools write, the most common first.
std::optional<EventColumns> columns_by_content(const std::vector<Row>& rows) {
  constexpr EventColumns kOrders[] = {{.t = 0, .x = 1, .y = 2, .p = 3},
                                      {.t = 3, .x = 0, .y = 1, .p = 2},
                                      {.t = 2, .x = 0, .y = 1, .p = 3},
                                      {.t = 0, .x = 2, .y = 3, .p = 1}};
  for (const EventColumns& order : kOrders)
    if (fits(rows, order)) return order;
  return std::nullopt;
}

/// "# geometry 240x180", "%geometry:1280,720".
std::optional<cv::Size> geometry_in_comment(std::string_view line) {
  constexpr std::string_view kKey = "geometry";
  const std::size_t at = line.find(kKey), size = line.find_first_of("0123456789", at);
  if (at == std::string_view::npos || size == std::string_view::npos) return std::nullopt;
  FieldReader fields(line.substr(size));
  const std::string first(fields.next());
  const auto both = parse_geometry(first);
  return both ? both : parse_geometry(fmt::format("{}x{}", first, fields.next()));
}

/// The lines at the beginning of a file: those above the events, and the numbers of the events.
struct EventRows {
  std::size_t header_lines = 0;
  std::optional<cv::Size> geometry;
  std::vector<Row> rows;
};

/// Rows have so many columns. Nothing if the first line of numbers is none, or without rows.
std::optional<EventRows> read_rows(std::string_view block, std::size_t columns, bool named) {
  EventRows found;
  for (std::size_t line = 1; !block.empty() && found.rows.size() < kMostRows; ++line) {
    const std::size_t end = block.find('\n');
    const std::string_view text = block.substr(0, end);
    block.remove_prefix(end + 1);
    if (text.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    auto numbers = numbers_of(text);
    if (numbers && numbers->size() == columns) {
      found.rows.push_back(std::move(*numbers));
      continue;
    }
    if (!found.rows.empty()) continue;  // a damaged line
    if (line >= kMostHeaderLines || (numbers && (named || numbers->size() != 2))) return std::nullopt;
    auto size = geometry_in_comment(text);
    if (numbers) size = parse_geometry(fmt::format("{}x{}", (*numbers)[0], (*numbers)[1]));  // in the format of E2VID
    if (numbers && !size) return std::nullopt;
    if (size) found.geometry = size;
    found.header_lines = line;
  }
  return found.rows.empty() ? std::nullopt : std::optional(std::move(found));
}

StampSample sample_stamps(const SourcePath& file, const std::vector<Row>& rows, const EventColumns& columns) {
  StampSample s{.count = rows.size(), .first = rows.front()[columns.t], .last = rows.front()[columns.t]};
  for (const Row& row : rows) {
    s.last = std::max(s.last, row[columns.t]);
    s.fractions = s.fractions || row[columns.t] != std::floor(row[columns.t]);
  }
  s.end = s.last;
  last_stamp(file, [&](std::string_view line) -> std::optional<Timestamp> {
    const auto numbers = numbers_of(line);
    if (!numbers || numbers->size() != columns.count) return std::nullopt;
    s.end = std::max(s.end, (*numbers)[columns.t]);
    return Timestamp();
  });
  return s;
}

bool is_text(std::string_view block) {
  return std::ranges::none_of(block, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 && c != '\t' && c != '\n' && c != '\r';
  });
}

/// The first line of numbers that is no event, with the reason; "" if there is none.
std::string first_that_is_no_event(const SourcePath& file, std::string_view block) {
  constexpr std::size_t kMostLines = 5000;
  for (std::size_t line = 1; line <= kMostLines && !block.empty(); ++line) {
    const std::size_t end = block.find('\n');
    std::string_view text = block.substr(0, end);
    if (text.ends_with('\r')) text.remove_suffix(1);
    Event event;
    const bool numbers = !text.empty() && (std::isdigit(static_cast<unsigned char>(text[0])) != 0 || text[0] == '-');
    if (numbers && end != std::string_view::npos && !parse_event_fields(text, {}, event))
      return fmt::format("{}:{}: {}", file.string(), line, why_no_event(text, {}));
    block.remove_prefix(std::min(end, block.size() - 1) + 1);
  }
  return "";
}

TimeUnit stamp_unit(const SourcePath& file, const EventTextForm& form, std::optional<TimeUnit> said) {
  if (said) return *said;
  if (form.unit_known) return form.columns.unit;
  if (const auto guess = guess_time_unit(form.stamps)) return *guess;
  const StampSample& s = form.stamps;
  throw InputError::format(
      "{}: the unit of its stamps is not certain (the first {} events take {:g}, all of them {:g}): give --time-unit "
      "s, "
      "ms, us or ns",
      file.string(), s.count, s.last - s.first, s.end - s.first);
}

class CsvWriter final : public RecordingWriter {
 public:
  explicit CsvWriter(const WriterSetup& setup) : file_(setup.path) {
    const cv::Size sensor = setup.event_sensor();
    file_.write(fmt::format("# geometry {}x{}\nt[s],x,y,p\n", sensor.width, sensor.height));
  }

  void write(const EventBatch& batch) override {
    text_.clear();
    for (const Event& e : batch.events)
      fmt::format_to(std::back_inserter(text_), FMT_COMPILE("{},{},{},{:d}\n"), format_seconds(e.t), e.x, e.y,
                     e.positive);
    file_.write({text_.data(), text_.size()});
  }

  void finish() override { file_.flush(); }

 private:
  OutputFile file_;
  fmt::memory_buffer text_;
};

}  // namespace

std::string why_no_event_file(const SourcePath& file) try {
  BlockReader blocks(file);
  const std::string_view block = blocks.next();
  return is_text(block) ? first_that_is_no_event(file, block) : "";
} catch (const InputError&) {
  return "";
}

std::optional<TimeUnit> guess_time_unit(const StampSample& stamps) {
  constexpr double kHour = 3600, kDay = 24 * kHour;
  constexpr double kYear2000 = 946'684'800, kYear2100 = 4'102'444'800;  // [s] of Unix time
  struct Bounds {
    double min_rate_hz, max_rate_hz, min_s, max_s;
  };
  const auto plausible = [&](TimeUnit unit, const Bounds& b) {
    const double seconds = seconds_of(unit);
    const double span = (stamps.last - stamps.first) * seconds, all = (stamps.end - stamps.first) * seconds;
    const double rate = static_cast<double>(stamps.count) / span, begin = stamps.first * seconds;
    const bool date = begin <= 30 * kDay || (begin >= kYear2000 && begin < kYear2100);  // since power-on, or of today
    return span > 0 && date && rate >= b.min_rate_hz && rate <= b.max_rate_hz && all >= b.min_s && all <= b.max_s;
  };
  if (stamps.fractions)
    return plausible(TimeUnit::Seconds, {1, 1e9, 0, kDay}) ? std::optional(TimeUnit::Seconds) : std::nullopt;
  std::optional<TimeUnit> only;
  for (const TimeUnit unit : kTimeUnits) {
    if (!plausible(unit, {3e3, 5e7, 0.1, kHour})) continue;
    if (only) return std::nullopt;
    only = unit;
  }
  return only;
}

EventColumns named_event_columns(const SourcePath& file) {
  const auto form = form_by_heading(file);
  return form ? form->columns : EventColumns();
}

std::optional<EventTextForm> find_event_form(const SourcePath& file) try {
  BlockReader blocks(file);
  std::string_view block = blocks.next();
  if (!is_text(block)) return std::nullopt;
  std::optional<EventTextForm> named;
  std::string complaint;
  try {
    named = form_by_heading(file);
  } catch (const InputError& e) {
    complaint = e.what();
  }
  const auto found = read_rows(block, named ? named->columns.count : 4, named.has_value());
  if (!found) return std::nullopt;
  EventTextForm form = named.value_or(EventTextForm());
  if (!named) {
    const auto columns = columns_by_content(found->rows);
    if (!columns) return std::nullopt;
    form.columns = *columns;
  }
  form.columns.header_lines = found->header_lines;
  form.geometry = found->geometry;
  form.stamps = sample_stamps(file, found->rows, form.columns);
  form.complaint = std::move(complaint);
  return form;
} catch (const InputError&) {
  return std::nullopt;  // not a text file
}

Recording open_event_csv(const SourcePath& file, const EventTextForm& form, const Rig* rig,
                         const RecordingOptions& options) {
  if (!form.complaint.empty()) spdlog::warn(form.complaint + " (columns found from the content)");
  const cv::Size size = event_sensor_size(file.string(), options.geometry ? options.geometry : form.geometry, rig);
  TextLayout layout;
  layout.info.name = std::filesystem::path(file.name()).stem().string();
  layout.info.format = "csv";
  layout.info.event_sensor = size;
  EventFile events{file, "events", size.width, size.height, form.columns};
  events.columns.unit = stamp_unit(file, form, options.time_unit);
  layout.events = {std::move(events)};
  return {open_text(std::move(layout)), std::nullopt};
}

std::unique_ptr<RecordingWriter> write_csv(const WriterSetup& setup) { return std::make_unique<CsvWriter>(setup); }

}  // namespace edged

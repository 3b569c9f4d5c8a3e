// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Parses and sorts the events of events.txt.
#include "edged/io/text/event_text.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr Duration kLateness = std::chrono::milliseconds(1);  // events this late are still sorted in
constexpr std::size_t kMaxHeld = 200'000;                     // events kept back for sorting
constexpr std::uint64_t kMaxSeconds = kMaxStampNs / 1'000'000'000 - 1;
constexpr std::array<std::uint64_t, 10> kPow10 = {1,       10,        100,        1'000,       10'000,
                                                  100'000, 1'000'000, 10'000'000, 100'000'000, 1'000'000'000};

static_assert(std::endian::native == std::endian::little,
              "parse_digits() takes the first character as the lowest byte");

unsigned digit(char c) { return static_cast<unsigned char>(c) - static_cast<unsigned>('0'); }
bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_separator(char c) { return is_blank(c) || c == ',' || c == ';'; }

/// Skips to the next field: blanks, with at most one comma or semicolon.
const char* skip_separator(const char* p) {
  while (is_blank(*p)) ++p;
  if (*p != ',' && *p != ';') return p;
  for (++p; is_blank(*p);) ++p;
  return p;
}

/// A whole number below 100000 and a separator; null otherwise. The '\n' ends every loop.
const char* parse_pixel(const char* p, std::uint16_t& value) {
  p = skip_separator(p);
  const char* const start = p;
  std::uint32_t v = 0;
  for (unsigned d; (d = digit(*p)) < 10 && p - start < 5; ++p) v = v * 10 + d;
  if (p == start || !is_separator(*p) || v > 65535) return nullptr;
  value = static_cast<std::uint16_t>(v);
  return p;
}

/// Leading digits, at most eight, and their value.
struct Digits {
  int count;
  std::uint64_t value;
};

/// Eight characters at once, each in its byte of a word: those of a number are at p.
Digits parse_digits(const char* p) {
  std::uint64_t word;
  std::memcpy(&word, p, sizeof word);
  word ^= 0x3030'3030'3030'3030;  // digits are 0 to 9 now
  // The lowest byte above 9 ends the number. It may carry into later bytes, which no longer matter.
  const std::uint64_t others = ((word + 0x7676'7676'7676'7676) | word) & 0x8080'8080'8080'8080;
  const int count = std::countr_zero(others) / 8;
  if (count == 0) return {0, 0};
  word <<= 64 - 8 * count;          // zeros lead
  word = word * 10 + (word >> 8U);  // pairs, in every second byte
  constexpr std::uint64_t kBytes = 0x0000'00FF'0000'00FF;
  const std::uint64_t value = (word & kBytes) * (100 + (std::uint64_t{1'000'000} << 32U)) +
                              ((word >> 16U) & kBytes) * (1 + (std::uint64_t{10'000} << 32U));
  return {count, value >> 32U};
}

constexpr std::ptrdiff_t kCommonLine = 64;  // parse_common_line() reads less than that

/// As parse_event_line() for the lines that programs write: fields of digits with one blank or comma between them, up
/// to 10 digits of seconds, 9 decimals and 4 digits of a pixel. Null for other lines. kCommonLine bytes must be
/// readable.
const char* parse_common_line(const char* p, Event& event) {
  const auto separates = [](char c) { return c == ' ' || c == ','; };
  Digits part = parse_digits(p);
  p += part.count;
  std::uint64_t seconds = part.value;
  if (part.count == 8)
    for (int i = 0; i < 2 && digit(*p) < 10; ++i) seconds = seconds * 10 + digit(*p++);
  if (part.count == 0 || *p != '.' || seconds > kMaxSeconds) return nullptr;
  part = parse_digits(++p);
  if (part.count != 8 || digit(p[8]) > 9 || !separates(p[9])) return nullptr;
  event.t = timestamp_from_ns(static_cast<std::int64_t>(seconds * kPow10[9] + part.value * 10 + digit(p[8])));
  p += 10;
  for (std::uint16_t* const pixel : {&event.x, &event.y}) {
    part = parse_digits(p);
    p += part.count;
    if (part.count == 0 || part.count > 4 || !separates(*p)) return nullptr;
    ++p;
    *pixel = static_cast<std::uint16_t>(part.value);
  }
  if (digit(*p) > 1) return nullptr;
  event.positive = *p++ == '1';
  p += *p == '\r';
  return *p == '\n' ? p + 1 : nullptr;
}

std::optional<std::uint16_t> whole_number(std::string_view field) {
  const auto value = parse_number(field);
  if (!value || *value < 0 || *value > 65535 || *value != std::floor(*value)) return std::nullopt;
  return static_cast<std::uint16_t>(*value);
}

}  // namespace

const char* parse_event_line(const char* p, Event& event) {
  while (is_blank(*p)) ++p;
  const char* start = p;
  std::uint64_t seconds = 0;
  for (unsigned d; (d = digit(*p)) < 10 && p - start < 11; ++p) seconds = seconds * 10 + d;
  if (p == start || seconds > kMaxSeconds) return nullptr;
  std::uint64_t ns = 0;
  if (*p == '.') {
    start = ++p;
    for (unsigned d; (d = digit(*p)) < 10 && p - start < 9; ++p) ns = ns * 10 + d;
    ns *= kPow10[static_cast<std::size_t>(9 - (p - start))];
    if (digit(*p) < 10 && digit(*p) >= 5) ++ns;
    while (digit(*p) < 10) ++p;
  }
  if (!is_separator(*p)) return nullptr;
  event.t = timestamp_from_ns(static_cast<std::int64_t>(seconds * kPow10[9] + ns));

  if (!(p = parse_pixel(p, event.x)) || !(p = parse_pixel(p, event.y))) return nullptr;
  p = skip_separator(p);
  if (digit(*p) > 1) return nullptr;
  event.positive = *p++ == '1';
  while (is_blank(*p) || *p == '\r') ++p;
  return *p == '\n' ? p + 1 : nullptr;
}

bool parse_event_fields(std::string_view line, const EventColumns& columns, Event& event) {
  FieldReader fields(line);
  std::array<std::string_view, EventColumns::kMost> field;
  for (std::size_t i = 0; i < columns.count; ++i) field[i] = fields.next();
  const auto t = parse_stamp(field[columns.t], columns.unit);
  const auto x = whole_number(field[columns.x]), y = whole_number(field[columns.y]);
  const auto p = parse_number(field[columns.p]);
  if (!t || !x || !y || !p || (*p != 0 && std::abs(*p) != 1) || !fields.rest().empty()) return false;
  event = {*t, *x, *y, *p > 0};
  return true;
}

std::string why_no_event(std::string_view line, const EventColumns& columns) {
  FieldReader fields(line);
  std::vector<std::string_view> field;
  while (!fields.rest().empty()) field.push_back(fields.next());
  if (field.size() != columns.count)
    return fmt::format(
        "{} column{} where an event of this file has {}", field.size(), field.size() == 1 ? "" : "s",
        columns == EventColumns{.header_lines = columns.header_lines} ? "4: t x y p" : std::to_string(columns.count));
  const auto wrong = [&](std::size_t column, const char* wanted) {
    return fmt::format("column {} ('{}') must be {}", column + 1, field[column].substr(0, 40), wanted);
  };
  if (!parse_stamp(field[columns.t], columns.unit)) return wrong(columns.t, "a stamp");
  for (const std::size_t pixel : {columns.x, columns.y})
    if (!whole_number(field[pixel])) return wrong(pixel, "a pixel, whole and from 0 on");
  return wrong(columns.p, "a polarity: 0 or 1, or -1 or 1");
}

std::optional<Timestamp> parse_event_stamp(std::string_view line, const EventColumns& columns) {
  Event event;
  return parse_event_fields(line, columns, event) ? std::optional(event.t) : std::nullopt;
}

EventTextStream::EventTextStream(const SourcePath& file, const EventColumns& columns, int width, int height,
                                 Repairs& repairs)
    : blocks_(file),
      damage_(file.string(), "events", repairs),
      columns_(columns),
      plain_(columns == EventColumns{.header_lines = columns.header_lines}),
      width_(width),
      height_(height) {
  EDGED_CHECK(width > 0 && height > 0, "sensor {} x {}", width, height);
}

const Event* EventTextStream::peek() {
  while (begin_ == ready_ && refill()) {
  }
  return begin_ < ready_ ? &events_[begin_] : nullptr;
}

std::vector<Event> EventTextStream::take_before(Timestamp end, std::size_t max_count) {
  std::vector<Event> taken;
  while (taken.size() < max_count && peek() && events_[begin_].t < end) {
    const auto first = events_.begin() + static_cast<std::ptrdiff_t>(begin_);
    const std::size_t room = std::min(ready_ - begin_, max_count - taken.size());
    const auto last = std::lower_bound(first, first + static_cast<std::ptrdiff_t>(room), end,
                                       [](const Event& e, Timestamp t) { return e.t < t; });
    taken.insert(taken.end(), first, last);
    begin_ += static_cast<std::size_t>(last - first);
    taken_ = taken.back().t;
  }
  return taken;
}

bool EventTextStream::refill() {
  if (at_end_) return false;
  events_.erase(events_.begin(), events_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  const std::string_view block = blocks_.next();
  at_end_ = block.empty();
  parse_block(block);
  if (at_end_) gate_.finish([this](const Event& passed) { place(passed); });
  ready_ = events_.size();
  if (at_end_ && !blocks_.damage().empty()) damage_.mended(line_, "file cut by damage", blocks_.damage());
  if (at_end_) return true;
  while (ready_ > 0 && events_[ready_ - 1].t >= newest_ - kLateness) --ready_;
  if (events_.size() - ready_ > kMaxHeld) ready_ = events_.size() - 1;  // constant stamps must not fill the memory
  return true;
}

void EventTextStream::parse_block(std::string_view block) {
  const char* p = block.data();
  const char* const end = p + block.size();
  while (p < end) {
    ++line_;
    Event event;
    const char* next = plain_ && end - p >= kCommonLine ? parse_common_line(p, event) : nullptr;
    if (!next && plain_) next = parse_event_line(p, event);
    if (!next) {
      next = p + std::string_view(p, static_cast<std::size_t>(end - p)).find('\n') + 1;
      const std::string_view line(p, static_cast<std::size_t>(next - p) - 1);
      if (!parse_event_fields(line, columns_, event)) {
        reject_line(line, next < end || !blocks_.unterminated());
        p = next;
        continue;
      }
    }
    p = next;
    if (event.x >= width_ || event.y >= height_) [[unlikely]] {
      damage_.bad(line_, "pixel outside the sensor",
                  fmt::format("pixel ({}, {}) outside the {} x {} sensor: is this its calibration?", event.x, event.y,
                              width_, height_));
    } else if (gate_.passes(event.t)) [[likely]] {
      place(event);
    } else {
      gate_.push(
          event, [this](const Event& passed) { place(passed); },
          [this](const Event& wrong, Timestamp following) {
            damage_.bad(
                line_, "stamp far ahead, dropped",
                fmt::format("stamp {} s is followed by {} s", format_seconds(wrong.t), format_seconds(following)));
          });
    }
  }
}

void EventTextStream::place(const Event& event) {
  if (event.t < newest_) [[unlikely]]
    return place_late(event);
  newest_ = event.t;
  events_.push_back(event);
}

void EventTextStream::place_late(const Event& event) {
  const auto first = events_.begin() + static_cast<std::ptrdiff_t>(begin_);
  if (newest_ - event.t < kLateness && event.t >= taken_) {
    const auto place =
        std::upper_bound(first, events_.end(), event.t, [](Timestamp t, const Event& e) { return t < e.t; });
    events_.insert(place, event);
    damage_.mended(line_, "out of order, sorted in", "stamp up to 1 ms before the line above");
    return;
  }
  // More than 1 ms late: this stamp is wrong, or the previous one is, if this stamp follows the one before that.
  const bool newest_is_wrong =
      first != events_.end() && (events_.end() - first > 1 ? (events_.end() - 2)->t : taken_) <= event.t;
  damage_.bad(line_, "out of order, dropped", "stamp more than 1 ms out of order");
  if (!newest_is_wrong) return;
  events_.back() = event;
  newest_ = event.t;
}

void EventTextStream::reject_line(std::string_view line, bool terminated) {
  FieldReader fields(line);
  const std::string_view first = fields.next();
  if (first.empty() || first[0] == '#' || line_ <= columns_.header_lines) return;
  if (!terminated) return damage_.mended(line_, "last line cut", "the file ends within a line");
  damage_.bad(line_, "unreadable line", why_no_event(line, columns_));
}

}  // namespace edged

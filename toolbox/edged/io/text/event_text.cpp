// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/text/event_text.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>

#include "edged/core/check.hpp"

namespace edged {
namespace {

constexpr Duration kLateness = std::chrono::milliseconds(1);  // events this late are still sorted in
constexpr std::size_t kMaxHeld = 200'000;                     // events kept back for sorting
constexpr std::uint64_t kMaxSeconds = kMaxStampNs / 1'000'000'000 - 1;
constexpr std::array<std::uint64_t, 10> kPow10 = {1,       10,        100,        1'000,       10'000,
                                                  100'000, 1'000'000, 10'000'000, 100'000'000, 1'000'000'000};

static_assert(std::endian::native == std::endian::little, "word_at() has the first character in the lowest byte");

unsigned digit(char c) { return static_cast<unsigned char>(c) - static_cast<unsigned>('0'); }

/// Characters at p, each in its byte of a word, the first in the lowest.
template <typename Word>
Word word_at(const char* p) {
  Word word;
  std::memcpy(&word, p, sizeof word);
  return word;
}

/// The highest bit of each byte above 9, at least up to the first one.
template <typename Word>
Word above_nine(Word bytes) {
  constexpr Word kEach = static_cast<Word>(0x0101'0101'0101'0101);
  return ((bytes + 0x76 * kEach) | bytes) & 0x80 * kEach;
}

/// What is behind a separator and at most one blank after it.
const char* after_separator(const char* p) {
  if (p[1] == ' ') [[unlikely]]
    return p + 2;
  return p + 1;
}

/// One to four digits before a separator, and what is behind it; null for others.
const char* parse_common_pixel(const char* p, char separator, std::uint16_t& value) {
  std::uint32_t digits = word_at<std::uint32_t>(p) ^ 0x3030'3030U;
  const int end = std::countr_zero(above_nine(digits) | std::uint64_t{1} << 39U);  // its bit; 39 after four digits
  if (end < 15 || p[static_cast<unsigned>(end) / 8] != separator) return nullptr;
  digits <<= static_cast<unsigned>(39 - end);  // zeros lead
  digits = digits * 10 + (digits >> 8U);       // pairs, in every second byte
  value = static_cast<std::uint16_t>((digits & 0x00FF'00FFU) * (1U + (100U << 16U)) >> 16U);
  return after_separator(p + static_cast<unsigned>(end) / 8);
}

/// The value of eight digits.
std::uint64_t value_of(std::uint64_t digits) {
  constexpr std::uint64_t kBytes = 0x0000'00FF'0000'00FF;
  digits = digits * 10 + (digits >> 8U);  // pairs, in every second byte
  return ((digits & kBytes) * (100 + (std::uint64_t{1'000'000} << 32U)) +
          ((digits >> 16U) & kBytes) * (1 + (std::uint64_t{10'000} << 32U))) >>
         32U;
}

/// One to nine decimals of a second, and what is behind them; null for others.
const char* parse_common_decimals(const char* p, std::uint64_t& ns) {
  const std::uint64_t digits = word_at<std::uint64_t>(p) ^ 0x3030'3030'3030'3030;
  const auto count = static_cast<unsigned>(std::countr_zero(above_nine(digits))) / 8;
  if (count == 8 && digit(p[8]) < 10) [[likely]] {
    ns = value_of(digits) * 10 + digit(p[8]);
    return p + 9;
  }
  if (count == 0) return nullptr;
  ns = value_of(digits << (64 - 8 * count)) * kPow10[9 - count];  // zeros lead
  return p + count;
}

/// The seconds before the point of a stamp. Most lines share those of the line before.
class CommonSeconds {
 public:
  static constexpr std::ptrdiff_t kBytes = 16;  ///< must be readable

  /// What is behind the point; null unless one to ten digits and a point are at p.
  const char* parse(const char* p) {
    const std::uint64_t differs =
        ((word_at<std::uint64_t>(p) ^ text_[0]) & mask_[0]) | ((word_at<std::uint64_t>(p + 8) ^ text_[1]) & mask_[1]);
    return differs == 0 || learn(p) ? p + size_ : nullptr;
  }
  std::uint64_t ns() const { return ns_; }

 private:
  bool learn(const char* p) {
    std::ptrdiff_t digits = 0;
    std::uint64_t seconds = 0;
    for (; digits < 10 && digit(p[digits]) < 10; ++digits) seconds = seconds * 10 + digit(p[digits]);
    if (digits == 0 || p[digits] != '.' || seconds > kMaxSeconds) return false;
    size_ = digits + 1;
    ns_ = seconds * kPow10[9];
    std::memcpy(text_.data(), p, kBytes);
    mask_ = {};
    std::memset(mask_.data(), 0xFF, static_cast<std::size_t>(size_));
    return true;
  }

  std::array<std::uint64_t, 2> text_{}, mask_{~std::uint64_t{0}, 0};  // no line begins with zeros
  std::ptrdiff_t size_ = 0;
  std::uint64_t ns_ = 0;
};

constexpr std::ptrdiff_t kCommonLine = 64;          // parse_common_line() reads less than that
constexpr std::ptrdiff_t kShortestCommonLine = 10;  // bytes

/// As parse_event_fields() for the lines that programs write: fields of digits with a separator between them, up to
/// 10 digits of seconds, 9 decimals and 4 digits of a pixel. Returns the next line, or null for other lines.
/// kCommonLine bytes must be readable.
const char* parse_common_line(const char* p, CommonSeconds& seconds, Event& event) {
  std::uint64_t ns;
  if (!(p = seconds.parse(p)) || !(p = parse_common_decimals(p, ns))) return nullptr;
  const char separator = *p;
  if (separator != ' ' && separator != ',' && separator != '\t' && separator != ';') return nullptr;
  p = after_separator(p);
  if (!(p = parse_common_pixel(p, separator, event.x)) || !(p = parse_common_pixel(p, separator, event.y)))
    return nullptr;
  event.t = timestamp_from_ns(static_cast<std::int64_t>(seconds.ns() + ns));
  const unsigned polarity = digit(*p++);
  event.positive = polarity != 0;
  if (*p == '\r') ++p;
  return *p == '\n' && polarity < 2 ? p + 1 : nullptr;
}

std::optional<std::uint16_t> whole_number(std::string_view field) {
  const auto value = parse_number(field);
  if (!value || *value < 0 || *value > 65535 || *value != std::floor(*value)) return std::nullopt;
  return static_cast<std::uint16_t>(*value);
}

}  // namespace

std::optional<double> parse_polarity(std::string_view field) {
  if (field == "True" || field == "true") return 1.0;
  return field == "False" || field == "false" ? std::optional(0.0) : parse_number(field);
}

bool parse_event_fields(std::string_view line, const EventColumns& columns, Event& event) {
  FieldReader fields(line);
  std::array<std::string_view, EventColumns::kMost> field;
  for (std::size_t i = 0; i < columns.count; ++i) field[i] = fields.next();
  const auto t = parse_stamp(field[columns.t], columns.unit);
  const auto x = whole_number(field[columns.x]), y = whole_number(field[columns.y]);
  const auto p = parse_polarity(field[columns.p]);
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
  return wrong(columns.p, "a polarity: 0 or 1, -1 or 1, or True or False");
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
  if (at_end_) jump_filter_.finish([this](const Event& passed) { place(passed); });
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
    if (const char* const rest = plain_ ? parse_common_lines(p, end) : p; rest != p) {
      p = rest;
      continue;
    }
    ++line_;
    Event event;
    const char* const next = p + std::string_view(p, static_cast<std::size_t>(end - p)).find('\n') + 1;
    const std::string_view line(p, static_cast<std::size_t>(next - p) - 1);
    p = next;
    if (!parse_event_fields(line, columns_, event)) {
      reject_line(line, next < end || !blocks_.unterminated());
    } else if (event.x >= width_ || event.y >= height_) {
      damage_.bad(line_, "pixel outside the sensor",
                  fmt::format("pixel ({}, {}) outside the {} x {} sensor: is this its calibration?", event.x, event.y,
                              width_, height_));
    } else if (jump_filter_.passes(event.t)) {
      place(event);
    } else {
      jump_filter_.push(
          event, [this](const Event& passed) { place(passed); },
          [this](const Event& wrong, Timestamp following) {
            damage_.bad(
                line_, "stamp far ahead, dropped",
                fmt::format("stamp {} s is followed by {} s", format_seconds(wrong.t), format_seconds(following)));
          });
    }
  }
}

/// As many lines as are of the common form, in order, and within the sensor. Returns the line after them.
const char* EventTextStream::parse_common_lines(const char* p, const char* end) {
  if (end - p < kCommonLine || !jump_filter_.passes(newest_)) return p;  // it holds some, or there is none before
  end = std::min(end - kCommonLine, p + kShortestCommonLine * static_cast<std::ptrdiff_t>(some_.size() - 1));
  const int width = width_, height = height_;
  CommonSeconds seconds;
  Timestamp newest = newest_;
  Event* event = some_.data();
  for (const char* next; p <= end; ++event, p = next) {
    next = parse_common_line(p, seconds, *event);
    if (!next || event->x >= width || event->y >= height || event->t < newest ||
        event->t - newest > jump_filter_.kAhead)
      break;
    newest = event->t;
  }
  const std::span<const Event> common(some_.data(), event);
  jump_filter_.push_first(common);
  events_.insert(events_.end(), common.begin(), common.end());
  newest_ = newest;
  line_ += common.size();
  return p;
}

void EventTextStream::place(const Event& event) {
  if (event.t < newest_) return place_late(event);
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

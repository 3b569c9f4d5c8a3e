// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Events from text lines `t x y p`: the parser and the stream built on it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/parse/repairs.hpp"
#include "edged/io/parse/stamp_jump_filter.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/measurement.hpp"

namespace edged {

/// The columns of an event in a line.
struct EventColumns {
  std::size_t t = 0, x = 1, y = 2, p = 3;  ///< counted from 0
  std::size_t count = 4;                   ///< columns in a line, at most kMost
  TimeUnit unit = TimeUnit::Seconds;
  std::size_t header_lines = 0;  ///< leading lines of the file without events
  static constexpr std::size_t kMost = 16;

  bool operator==(const EventColumns&) const = default;
};

/// The columns and the unit of the heading of a file, the default without a heading. Throws InputError as
/// find_heading() does.
EventColumns named_event_columns(const SourcePath& file);

/// A number, True or False.
std::optional<double> parse_polarity(std::string_view field);

/// Parses a line: stamp (exact to the nanosecond), column, row, polarity 0 or 1 (or -1, True, False), in any order and
/// notation of numbers (exponents, `96.0`), separated by blanks, commas or semicolons. False if the line is no event.
bool parse_event_fields(std::string_view line, const EventColumns& columns, Event& event);

/// What keeps the line from being an event, by its column as the user counts: "column 3 ('abc') must be ...".
std::string why_no_event(std::string_view line, const EventColumns& columns);

/// Parses the stamp only.
std::optional<Timestamp> parse_event_stamp(std::string_view line, const EventColumns& columns);

/// The events of a file in time order. Memory is bounded: a block of text and its events. An StampJumpFilter checks for
/// stamps far ahead. Events up to 1 ms late are sorted in; later ones, those outside the sensor and unreadable lines
/// are left out. All are counted.
class EventTextStream {
 public:
  EventTextStream(const SourcePath& file, const EventColumns& columns, int width, int height, Repairs& repairs);

  /// The next event, or null at the end.
  const Event* peek();

  /// The events before `end`, at most max_count of them (a limit for damaged files whose stamps stand still).
  std::vector<Event> take_before(Timestamp end, std::size_t max_count = 65536);

 private:
  bool refill();
  void parse_block(std::string_view block);
  const char* parse_common_lines(const char* p, const char* end);
  void place(const Event& event);
  void place_late(const Event& event);
  void reject_line(std::string_view line, bool terminated);

  BlockReader blocks_;
  LineDamage damage_;
  EventColumns columns_;
  bool plain_;  ///< parse_common_lines() reads this form
  int width_, height_;
  std::size_t line_ = 0;
  std::array<Event, 512> some_;         ///< parsed at once: to append each to a vector takes longer
  std::vector<Event> events_;           ///< sorted
  std::size_t begin_ = 0;               ///< first event not yet taken
  std::size_t ready_ = 0;               ///< events before this index can no longer change
  Timestamp taken_ = Timestamp::min();  ///< stamp of the last event taken
  Timestamp newest_ = Timestamp::min();
  bool at_end_ = false;
  StampJumpFilter<Event> jump_filter_;
};

}  // namespace edged

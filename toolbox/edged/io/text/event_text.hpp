// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Text files with one event per line, written by any tool: the parser, the stream built on it, and the detection of
// the order of columns and the unit of stamps.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edged/io/core/recording_writer.hpp"
#include "edged/io/parse/repairs.hpp"
#include "edged/io/parse/stamp_jump_filter.hpp"
#include "edged/io/parse/text_parsing.hpp"
#include "edged/io/recording.hpp"
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

/// The stamps at the beginning of a file and its last one, in their unknown unit.
struct StampSample {
  std::size_t count = 0;  ///< number of events from first to last
  double first = 0, last = 0;
  double end = 0;  ///< the last stamp of the file if known, else `last`
  bool fractions = false;
};

/// The only unit that gives a plausible event rate, duration and date. Stamps with fractions are seconds. Nothing if
/// several units or none are plausible.
std::optional<TimeUnit> guess_time_unit(const StampSample& stamps);

/// The form of a file, by its first lines.
struct EventTextForm {
  EventColumns columns;
  bool unit_known = false;
  std::optional<cv::Size> geometry;  ///< "# geometry WxH", or a first line `W H`
  StampSample stamps;
  std::string complaint =
      {};  ///< about a heading with unknown names, without which the columns are found from the content
};

/// The first line of a text file that holds numbers but no event, with the reason; "" if there is none.
std::string why_no_event_file(const SourcePath& file);

/// Nothing if the file has no lines of events: numbers `t x y p`, or in another order that fits events only, or after a
/// line that names the columns.
std::optional<EventTextForm> find_event_form(const SourcePath& file);

/// The camera is "events". Throws InputError if the unit of the stamps is neither given nor certain.
Recording open_event_csv(const SourcePath& file, const EventTextForm& form, const Rig* rig,
                         const RecordingOptions& options);

/// Writes lines `t[s],x,y,p` with nine decimals of the seconds.
std::unique_ptr<RecordingWriter> write_csv(const WriterSetup& setup);

}  // namespace edged

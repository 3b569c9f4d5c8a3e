// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Events alone, one a line, in a text file of any tool: order of columns and unit of the stamps found from its content.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "edged/io/recording.hpp"
#include "edged/io/recording_writer.hpp"
#include "edged/io/text/event_text.hpp"

namespace edged {

/// The stamps of a file in their unknown unit: those of its begin, and its last.
struct StampSample {
  std::size_t count = 0;  ///< from first to last
  double first = 0, last = 0;
  double end = 0;  ///< the last of the file, or `last`
  bool fractions = false;
};

/// The only unit in which the events would come at a rate, for a time and at a date that recordings have; fractions
/// mean seconds. Nothing where several units would do, or none.
std::optional<TimeUnit> guess_time_unit(const StampSample& stamps);

/// What the first lines of a file tell.
struct EventTextForm {
  EventColumns columns;
  bool unit_known = false;
  std::optional<cv::Size> geometry;  ///< "# geometry WxH", or a first line `W H`
  StampSample stamps;
  std::string complaint = {};  ///< of a heading with names that are not known: the columns are those of the content
};

/// Nothing where the file holds no lines of events: numbers `t x y p` or in another order that only fits as events, or
/// below a line that names the columns.
std::optional<EventTextForm> find_event_form(const SourcePath& file);

/// Camera "events". Throws InputError where the unit of the stamps is neither said nor certain.
Recording open_event_csv(const SourcePath& file, const EventTextForm& form, const Rig* rig,
                         const RecordingOptions& options);

/// `t[s],x,y,p` with all nine decimals of the seconds.
std::unique_ptr<RecordingWriter> write_csv(const WriterSetup& setup);

}  // namespace edged

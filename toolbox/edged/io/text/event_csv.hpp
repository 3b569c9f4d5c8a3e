// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Text files with one event per line, written by any tool. Order of columns and unit of stamps are detected.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "edged/io/core/recording_writer.hpp"
#include "edged/io/recording.hpp"
#include "edged/io/text/event_text.hpp"

namespace edged {

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

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Files of Prophesee cameras: RAW in EVT 2.0, 2.1, 3.0 and 4.0, with old and new headers, and DAT.
#pragma once

#include <string>

#include "edged/io/archive/bytes.hpp"
#include "edged/io/core/recording_writer.hpp"
#include "edged/io/parse/evt.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// The content of the text lines at the beginning of a file.
struct PropheseeHeader {
  EvtFormat format = EvtFormat::Evt2;
  std::optional<cv::Size> geometry;  ///< sensor [px], from the header or by the name of the camera
  Duration time_offset{0};           ///< to be added to all stamps; only in files of this program
  std::size_t bytes = 0;             ///< offset of the events
};

/// Parses the first bytes of a file. Throws InputError, with `file`, if it has no events of a known encoding.
PropheseeHeader read_prophesee_header(ByteSpan head, const std::string& file);

/// head: the first bytes of a file.
bool is_prophesee_file(ByteSpan head);
/// Options used: the geometry of the sensor.
Recording open_prophesee(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options);

/// Key of a header line that only this program knows: microseconds to be added to all stamps, as the counters of EVT 3
/// (16.8 s) and DAT (71 min) cannot hold a time of day. Other programs ignore it and read stamps that begin at zero.
inline constexpr std::string_view kTimeOffsetKey = "edged_time_offset_us";

/// Events as EVT 3.0, with stamps in whole microseconds.
std::unique_ptr<RecordingWriter> write_raw(const WriterSetup& setup);
/// Events as DAT records of 8 bytes.
std::unique_ptr<RecordingWriter> write_dat(const WriterSetup& setup);

}  // namespace edged

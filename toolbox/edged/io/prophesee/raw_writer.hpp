// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes files of Prophesee cameras. Internal to io.
#pragma once

#include "edged/io/core/recording_writer.hpp"

namespace edged {

/// Key of a header line that only this program knows: microseconds to be added to all stamps, as the counters of EVT 3
/// (16.8 s) and DAT (71 min) cannot hold a time of day. Other programs ignore it and read stamps that begin at zero.
inline constexpr std::string_view kTimeOffsetKey = "edged_time_offset_us";

/// Events as EVT 3.0, with stamps in whole microseconds.
std::unique_ptr<RecordingWriter> write_raw(const WriterSetup& setup);
/// Events as DAT records of 8 bytes.
std::unique_ptr<RecordingWriter> write_dat(const WriterSetup& setup);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Files of Prophesee cameras: RAW in EVT 2.0, 2.1, 3.0 and 4.0, with old and new headers, and DAT.
#pragma once

#include "edged/io/archive/bytes.hpp"
#include "edged/io/core/recording_writer.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// head: the first bytes of a file.
bool is_prophesee_file(ByteSpan head);
/// Options used: the geometry of the sensor.
Recording open_prophesee(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options);

/// Events as EVT 3.0, with stamps in whole microseconds.
std::unique_ptr<RecordingWriter> write_raw(const WriterSetup& setup);
/// Events as DAT records of 8 bytes.
std::unique_ptr<RecordingWriter> write_dat(const WriterSetup& setup);

}  // namespace edged

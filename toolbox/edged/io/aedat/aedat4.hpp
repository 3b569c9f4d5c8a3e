// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// AEDAT4 files of iniVation's DV: events, frames and IMU in compressed packets.
#pragma once

#include "edged/io/archive/bytes.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// From the first bytes of a file.
bool is_aedat4(ByteSpan head);

/// Cameras "events" and "frames"; stamps in Unix time. Options used: the geometry of the event sensor, for files
/// without one, and the topics: the names of streams, where several have the same type.
Recording open_aedat4(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Event Stream files (.es), version 2, of DVS and ATIS cameras.
#pragma once

#include "edged/io/archive/bytes.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// head: the first bytes of a file.
bool is_event_stream(ByteSpan head);
/// Options used: the geometry of the sensor.
Recording open_event_stream(const std::filesystem::path& file, const Rig* rig, const RecordingOptions& options);

}  // namespace edged

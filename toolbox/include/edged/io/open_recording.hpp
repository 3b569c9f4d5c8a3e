// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens a recording on disk, whatever its format.
#pragma once

#include <filesystem>

#include "edged/io/recording.hpp"

namespace edged {

/// Opens a folder or a file, its format found by content (docs/formats.md lists the formats). Cameras are "events" and
/// "frames", of EuRoC "cam0" and others that options name. Ground truth is of "body" or of a camera, as the recording
/// has it. A folder may hold one such file, an IMU in a csv or txt beside it and a calibration.yaml of ours;
/// what else lies there is logged as not read. `rig` is the rig the user chose, if any: its event camera bounds the
/// pixels, and a clear warning is logged when it contradicts the recording. Throws InputError that lists what was
/// looked for.
Recording open_recording(const std::filesystem::path& path, const Rig* rig = nullptr,
                         const RecordingOptions& options = {});

}  // namespace edged

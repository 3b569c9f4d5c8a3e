// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens a recording on disk, whatever its format.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "edged/core/dataset.hpp"
#include "edged/io/calibration.hpp"

namespace edged {

struct Recording {
  std::unique_ptr<Dataset> dataset;
  std::optional<Calibration> calibration;  ///< where the recording brings a complete one (EuRoC, calibration.yaml)
};

/// Opens a folder, its format found by content:
/// - Event-Camera Dataset text (events.txt, images.txt, imu.txt, groundtruth.txt, calib.txt; one sensor is enough).
///   Cameras "events" and "frames", ground truth of "events". A calibration.yaml of ours there counts.
/// - EuRoC ASL (mav0 or its parent): camera "cam0", ground truth of "body".
/// `rig` is the rig the user chose, if any: its event camera bounds the pixels, and a clear warning is logged when it
/// contradicts the recording's own calib.txt. Throws InputError that lists what was looked for.
Recording open_recording(const std::filesystem::path& folder, const Rig* rig = nullptr);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes any data set as an Event-Camera Dataset text folder.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>

#include "edged/core/dataset.hpp"
#include "edged/io/calibration.hpp"

namespace edged {

struct EcdWriteOptions {
  /// Written as calib.txt (event camera) and calibration.yaml (everything); also turns body ground truth into that of
  /// the camera, which is what groundtruth.txt holds.
  std::optional<Calibration> calibration;
  std::function<void(Timestamp)> progress;  ///< called now and then with the stamp reached
};

struct EcdWriteCounts {
  std::size_t events = 0, frames = 0, imu = 0, poses = 0;
};

/// Reads `dataset` to its end and writes events.txt, images.txt with images/, imu.txt and groundtruth.txt, each only if
/// there is something in it. Read back, every stamp, event, pixel and number is the same to the last bit. The data set
/// must hold at most one event camera and one frame camera. Throws InputError when the folder cannot be written,
/// already holds a recording, or the ground truth is of the body and no calibration is given.
EcdWriteCounts write_ecd(Dataset& dataset, const std::filesystem::path& folder, const EcdWriteOptions& options = {});

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens a recording on disk, whatever its format.
#pragma once

#include <filesystem>

#include "edged/io/recording.hpp"

namespace edged {

/// Opens a folder or a file, its format found by content:
/// - Event-Camera Dataset text (events.txt, images.txt, imu.txt, groundtruth.txt, calib.txt; one sensor is enough).
///   Cameras "events" and "frames", ground truth of "events". A calibration.yaml of ours there counts.
/// - EuRoC ASL and TUM-VI (mav0 or its parent): camera "cam0", ground truth of "body".
/// - A zip archive of one of these.
/// - A folder with one file of the kinds below, an IMU in a csv or txt beside it, a calibration.yaml of ours; what else
///   lies there is logged as not read.
/// - Prophesee RAW (EVT 2.0, 2.1, 3.0) and DAT: camera "events".
/// - Plain text of events, csv or separated by blanks, also as .gz: camera "events".
/// - AEDAT4: cameras "events" and "frames".
/// - HDF5 (DSEC, VECtor, TUM-VIE, M3ED, MVSEC, EDS, Metavision; folder or file): cameras "events" and "frames", ground
///   truth of "body", "events" or "frames", as the set has it.
/// - ROS 1 bag, ROS 2 bag (SQLite or MCAP, file or folder): cameras "events" and "frames", ground truth of "body", or
///   of the camera that its messages name so.
/// `rig` is the rig the user chose, if any: its event camera bounds the pixels, and a clear warning is logged when it
/// contradicts the recording. Throws InputError that lists what was looked for.
Recording open_recording(const std::filesystem::path& path, const Rig* rig = nullptr,
                         const RecordingOptions& options = {});

}  // namespace edged

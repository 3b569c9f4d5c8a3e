// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens a recording on disk, whatever its format.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "edged/core/dataset.hpp"
#include "edged/io/calibration.hpp"
#include "edged/io/text.hpp"

namespace edged {

struct Recording {
  std::unique_ptr<Dataset> dataset;
  /// Where the recording brings one: complete (EuRoC, calibration.yaml) or intrinsics (bags).
  std::optional<Calibration> calibration;
};

/// What the user may say of a recording that it does not tell itself, or not clearly.
struct RecordingOptions {
  std::optional<cv::Size> geometry = std::nullopt;   ///< size of the event sensor [px], for files that do not hold it
  std::optional<TimeUnit> time_unit = std::nullopt;  ///< of the stamps in plain event files, where it is not certain
  /// Of live sources: whether the user has had enough; asked several times a second.
  std::function<bool()> interrupted = {};
  /// Of bags and AEDAT4: role ("events", "frames", "imu", "truth") to topic or "none".
  std::map<std::string, std::string> topics = {};
};

/// "640x480"; nothing where it is no size.
std::optional<cv::Size> parse_geometry(std::string_view text);

/// Opens a folder or a file, its format found by content:
/// - Event-Camera Dataset text (events.txt, images.txt, imu.txt, groundtruth.txt, calib.txt; one sensor is enough).
///   Cameras "events" and "frames", ground truth of "events". A calibration.yaml of ours there counts.
/// - EuRoC ASL and TUM-VI (mav0 or its parent): camera "cam0", ground truth of "body".
/// - A zip archive of one of these.
/// - Prophesee RAW (EVT 2.0, 2.1, 3.0) and DAT: camera "events".
/// - Plain text of events, csv or separated by blanks: camera "events".
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

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A recording as it has been opened, and what its user may say of it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <opencv2/core/types.hpp>
#include <optional>
#include <string>
#include <vector>

#include "edged/dataset.hpp"
#include "edged/io/calibration_data.hpp"
#include "edged/io/time_unit.hpp"

namespace edged {

struct Recording {
  std::unique_ptr<Dataset> dataset;
  /// Where the recording brings one: complete (EuRoC, calibration.yaml) or intrinsics (bags).
  std::optional<Calibration> calibration;
};

/// What the user may say of a recording that it does not contain, or not clearly.
struct RecordingOptions {
  std::optional<cv::Size> geometry = std::nullopt;  ///< size of the event sensor [px], for files that do not hold it
  std::optional<TimeUnit> time_unit =
      std::nullopt;  ///< unit of the stamps in plain event files, where it is not certain
  /// For live sources: whether the user has had enough; asked several times a second.
  std::function<bool()> interrupted = {};
  /// For bags and AEDAT4: role ("events", "frames", "imu", "truth") or name of a camera to topic or "none".
  std::map<std::string, std::string> topics = {};
  /// For bags: name of a camera to its topic, as the calibration states it (Calibration::topics).
  std::map<std::string, std::string> camera_topics = {};
  /// Names of the cameras to read, where a recording has several of a kind: those of the rig, else "events", "events2",
  /// "frames", "frames2", of EuRoC "cam0", "cam1". None of a kind: its first.
  std::vector<std::string> cameras = {};
  /// True: all cameras are read.
  bool all_cameras = false;
  /// False: the IMU file of the recording is not opened, as the user gives another one.
  bool own_imu = true;
  /// True: the IMU file beside the recording may be on another clock, which the caller corrects.
  bool imu_has_own_clock = false;
};

}  // namespace edged

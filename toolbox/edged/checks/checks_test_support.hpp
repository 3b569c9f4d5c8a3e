// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What the tests of the checks share: a healthy recording, and the remedy of a finding.
#pragma once

#include <string>
#include <vector>

#include "edged/checks/checks.hpp"

namespace edged {

inline StreamStatistics stream(std::size_t count, double begin_s, double end_s) {
  StreamStatistics s;
  s.count = count;
  s.begin = timestamp_from_seconds(begin_s), s.end = timestamp_from_seconds(end_s);
  s.typical_step = (*s.end - *s.begin) / static_cast<Duration::rep>(count);
  return s;
}

inline RecordingStatistics healthy() {
  RecordingStatistics s;
  s.events = stream(1'000'000, 0, 10);
  s.frames = stream(200, 0, 10);
  s.imu = stream(2000, 0, 10);
  s.event_details.positive_share = 0.5;
  s.imu_details.mean_accel = 9.8, s.imu_details.mean_gyro = 0.3, s.imu_details.max_gyro = 1.0;
  s.mean_brightness = 100;
  return s;
}

inline CameraCheck agreeing() {
  GyroAgreement found;
  found.turns = 200, found.turning = std::chrono::seconds(10), found.unexplained = 0.1, found.rotation_sigma = 2e-3;
  found.time_sigma_s = 1e-4, found.time_t = 20.0;
  found.rotation_covariance = 4e-6 * Eigen::Matrix3d::Identity();
  return {RigCamera{"cam", Modality::Frames, {}, {}, Duration(0)}, true, found};
}

/// The remedy of the first finding of that severity that contains this text.
inline std::string remedy_of(const std::vector<Finding>& findings, Severity severity, const std::string& text) {
  for (const Finding& f : findings)
    if (f.severity == severity && f.text.find(text) != std::string::npos) return f.remedy;
  return "NO SUCH FINDING";
}

inline std::string remedy_of(const RecordingStatistics& recording, const std::vector<CameraCheck>& cameras,
                             Severity severity, const std::string& text) {
  return remedy_of(check_recording({recording, !cameras.empty(), cameras}), severity, text);
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// A calibration from a target: as text, as json for programs and for the page of the report.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "edged/calibrate/coverage.hpp"
#include "edged/calibrate/rig_fit.hpp"
#include "edged/checks/found_imu_clock.hpp"
#include "edged/io/calibration_data.hpp"
#include "edged/target/target.hpp"

namespace edged {

struct TargetCalibration {
  std::string recording;
  TargetSpec target;
  std::vector<TargetCamera> cameras;
  std::vector<ViewCoverage> coverage;       ///< of each camera
  std::vector<std::string> advice;          ///< what a better recording has
  std::optional<ChosenImuClock> imu_clock;  ///< of --imu-time-offset auto
  RigFit fit;
  double seconds = 0.0;  ///< that it took
};

/// The cameras as a calibration of the format of this program; imu: its noise.
Calibration to_calibration(const TargetCalibration& result, const std::string& name, const ImuNoise* imu);

std::string to_text(const TargetCalibration& result);
nlohmann::ordered_json to_json(const TargetCalibration& result);
/// The json with coverage and residuals, in a page that needs nothing else.
std::string target_page(const TargetCalibration& result);

}  // namespace edged

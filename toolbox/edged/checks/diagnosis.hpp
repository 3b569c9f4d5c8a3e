// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Problems of a recording or its calibration, with remedies.
#pragma once

#include <string>
#include <vector>

#include "edged/checks/camera_check.hpp"
#include "edged/checks/finding.hpp"
#include "edged/checks/statistics/survey.hpp"

namespace edged {

/// The remedy for a camera whose inverse transform fits.
inline constexpr const char* kTurnRound =
    "the transform points the other way, and so does its translation, which no run corrects: write it as T_C_B "
    "(`edged calib` shows both directions)";

/// True if a finding states an error of the IMU itself.
bool imu_unusable(const std::vector<Finding>& findings);

/// In the order of their subjects: streams, IMU, events, frames, external sensors, calibration, ground truth, repairs.
/// calibrated: there is a calibration, possibly of other cameras than the recorded ones.
std::vector<Finding> diagnose(const Survey& survey, bool calibrated, const std::vector<CameraCheck>& cameras);

}  // namespace edged

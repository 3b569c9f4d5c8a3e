// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Problems of an IMU: rate, gaps, clock, constant readings, units.
#pragma once

#include <vector>

#include "edged/checks/camera_check.hpp"
#include "edged/checks/finding.hpp"
#include "edged/checks/statistics/survey.hpp"

namespace edged {

void judge_imu(const Survey& survey, const std::vector<CameraCheck>& cameras, Findings& out);

}  // namespace edged

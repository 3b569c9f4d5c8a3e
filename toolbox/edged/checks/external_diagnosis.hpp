// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Problems of height and velocity sensors, for the diagnosis of a recording.
#pragma once

#include <vector>

#include "edged/checks/finding.hpp"
#include "edged/checks/statistics/external_survey.hpp"

namespace edged {

/// Rate, gaps, time, units, numbers that do not change, and sigmas that are too small; in the order of their names.
void judge_external(const ExternalSurveys& surveys, const StreamSurvey& imu, std::vector<Finding>& out);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The verdict on the result of a run, without ground truth.
#pragma once

#include <string>
#include <vector>

#include "common/source.hpp"
#include "edged/odometry.hpp"
#include "edged/rig.hpp"
#include "edged/survey/calibration_fit.hpp"
#include "edged/survey/diagnosis.hpp"
#include "run/run_statistics.hpp"

namespace edged {

/// The estimated calibration of each camera.
std::vector<CalibrationFound> compare_calibrations(const Rig& given, Odometry& odometry,
                                                   const CalibrationConfig& config);

/// The given calibration with the estimated rotation and clock of the cameras.
Calibration with_found(Calibration given, const Rig& found);

struct Verdict {
  std::vector<Finding> findings;  ///< warnings and errors
  bool contradicted = false;      ///< by recording, calibration or the estimate itself
  bool trusted = true;            ///< not contradicted, and there is a result
  std::string waiting_for;        ///< never good, or lost at the end: the last reason
  std::string next;               ///< the command to run then; may be empty
};

/// findings: of recording and calibration.
Verdict judge_run(std::vector<Finding> findings, const RunStatistics& statistics,
                  const std::vector<CalibrationFound>& calibration, const SourceOptions& source);

}  // namespace edged

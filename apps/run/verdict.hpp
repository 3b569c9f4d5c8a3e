// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether the result of a run can be trusted, by what is known without ground truth.
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

/// What the run found of the calibration of each camera.
std::vector<CalibrationFound> compare_calibrations(const Rig& given, Odometry& odometry,
                                                   const CalibrationConfig& config);

/// The given one with rotation and clock of the cameras that were found.
Calibration with_found(Calibration given, const Rig& found);

struct Verdict {
  std::vector<Finding> findings;  ///< warnings and errors
  bool contradicted = false;      ///< by recording, calibration or the estimate itself
  bool trusted = true;            ///< not contradicted, and there is a result
  std::string waiting_for;        ///< never good, or lost at the end: what was missing last
  std::string next;               ///< the command to run then; empty where there is nothing to be done
};

/// findings: of recording and calibration.
Verdict judge_run(std::vector<Finding> findings, const RunStatistics& statistics,
                  const std::vector<CalibrationFound>& calibration, const SourceOptions& source);

}  // namespace edged

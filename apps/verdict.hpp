// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether the result of a run can be trusted, by what is known without ground truth.
#pragma once

#include <string>
#include <vector>

#include "edged/odometry.hpp"
#include "edged/rig.hpp"
#include "edged/survey/diagnosis.hpp"
#include "run_statistics.hpp"
#include "source.hpp"

namespace edged {

/// What the run found a camera's calibration to be off by.
struct CalibrationFound {
  std::string camera;
  double rotation_deg = 0.0;    ///< between T_B_C as given and as found
  double time_offset_ms = 0.0;  ///< found, the whole of it
  double given_offset_ms = 0.0;
  bool beyond = false;  ///< farther off than estimator.calibration.* says it may be: not corrected, but wrong
  std::optional<double> rotation_sigma_deg, time_sigma_ms;  ///< of what was found; nothing where there is no estimate
  bool inverse = false;                                     ///< the inverse of the given rotation is what was found

  bool estimated() const { return rotation_sigma_deg && time_sigma_ms; }
};
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

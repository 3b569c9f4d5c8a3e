// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The verdict on the result of a run. Terminal, page, picture, metrics.json and exit code share it.
#pragma once

#include <string>
#include <vector>

#include "common/source.hpp"
#include "edged/checks/calibration_fit.hpp"
#include "edged/checks/checks.hpp"
#include "edged/odometry.hpp"
#include "edged/rig.hpp"
#include "run/run_statistics.hpp"

namespace edged {

/// The estimated calibration of each camera.
std::vector<CalibrationFound> compare_calibrations(const Rig& given, Odometry& odometry,
                                                   const CalibrationConfig& config);

/// Of position and lens: what was found of a camera minus what is given.
std::vector<CorrectionFound> corrections_of(const RigCamera& given, const RigCamera& found,
                                            const CalibrationCovariance& P, const CalibrationConfig& config);

/// The given calibration with the estimated lens, pose and clock of these cameras. Other cameras behind the same lens
/// get its lens and pose, and so remain behind one lens in the next run.
Calibration with_found(Calibration given, const Rig& found);

struct Verdict {
  std::vector<Finding> findings;  ///< warnings and errors
  bool contradicted = false;      ///< by recording, calibration, the estimate itself, or ground truth
  bool trusted = true;            ///< not contradicted, and there is a result
  std::string text;               ///< in one line, the same wherever it is shown
  std::string waiting_for;        ///< never good, or lost at the end: the last reason
  std::string next;               ///< the next step: a command, or the page to open

  /// Without any finding.
  bool plain() const { return trusted && findings.empty(); }
};

enum class Ending { Complete, Interrupted, BrokenOff };

struct RunSummary;

/// Sets status and verdict by all that the summary holds: the findings so far (of recording and map), the estimate, and
/// how it compares with ground truth. Once, when nothing more will be known.
void judge_run(RunSummary& summary, const SourceOptions& source, Ending ending);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether the result of a run can be trusted: one verdict, which terminal, page, picture, metrics.json and exit code
// share.
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
  bool contradicted = false;      ///< by recording, calibration, the estimate itself, or ground truth
  bool trusted = true;            ///< not contradicted, and there is a result
  std::string text;               ///< in one line, the same wherever it is shown
  std::string waiting_for;        ///< never good, or lost at the end: what was missing last
  std::string next;               ///< what to do next: a command, or the page to open

  /// Nothing but good to say.
  bool plain() const { return trusted && findings.empty(); }
};

enum class Ending { Complete, Interrupted, BrokenOff };

struct RunSummary;

/// Sets status and verdict by all that the summary holds: the findings so far (of recording and map), the estimate, and
/// how it compares with ground truth. Once, when nothing more will be known.
void judge_run(RunSummary& summary, const SourceOptions& source, Ending ending);

}  // namespace edged

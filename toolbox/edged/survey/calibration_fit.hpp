// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether what a run found of a calibration is what was given.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "edged/survey/diagnosis.hpp"

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
  bool events = false;                                      ///< its pixels have a latency, which is part of its clock

  bool estimated() const { return rotation_sigma_deg && time_sigma_ms; }
};

enum class Fit { Fits, DoesNotFit, CannotBeTold };

struct CameraFit {
  CalibrationFound found;
  Fit fit = Fit::CannotBeTold;
  std::string why;  ///< one line: figures, and what to write where it does not fit
};

/// All of it: as good as the worst of its cameras, and what contradicts beside them.
struct CalibrationFit {
  std::vector<CameraFit> cameras;
  std::vector<Finding> findings;  ///< warnings and errors of recording and calibration
  Fit fit = Fit::CannotBeTold;
  std::string why;
};

/// Whether the run found its rotation or its clock to be another than the one given.
bool is_off(const CalibrationFound& found);

/// found: without sigmas where there is no estimate. findings: those of `camera NAME: ...` count against that camera,
/// other errors against all. missing: what an estimate waited for last, may be empty.
CalibrationFit judge_fit(const std::vector<CalibrationFound>& found, std::vector<Finding> findings,
                         const std::string& missing);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Whether what a run found of a calibration is what was given, in words.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "edged/survey/diagnosis.hpp"
#include "verdict.hpp"

namespace edged {

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

std::string to_text(const CalibrationFit& fit);
nlohmann::ordered_json to_json(const CalibrationFit& fit);

}  // namespace edged

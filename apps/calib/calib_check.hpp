// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged calib --check`: whether a calibration fits a recording, by a short run over it.
#pragma once

#include <filesystem>
#include <string>

#include "common/source.hpp"
#include "edged/checks/calibration_fit.hpp"
#include "run/estimated_calibration.hpp"

namespace edged {

struct CalibCheckOptions {
  SourceOptions source;
  std::string mode = "auto";
  std::filesystem::path out;  ///< output file for the estimated calibration; "" for none
  bool quiet = false, json = false;
};

inline constexpr double kCheckedSeconds = 20.0;  ///< default length of the used part of a recording

/// What a run over a recording found.
struct CalibrationRun {
  CalibrationFit fit;
  Rig found;
  CalibrationCovariances covariances;
};

/// A run like that of `edged run`, without its files, that asks each camera by itself. begin: the initial calibration
/// of the cameras.
CalibrationRun calibrate_by_run(const Rig& begin, Source& source, Mode mode, bool quiet);

/// Prints the verdict and returns the exit code: 0 fits, 5 does not, 4 cannot be determined.
int check_calibration(CalibCheckOptions options);

}  // namespace edged

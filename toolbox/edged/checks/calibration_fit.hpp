// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Compares the calibration estimated by a run with the given one.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "edged/checks/checks.hpp"

namespace edged {

/// A number of a camera's calibration: estimated minus given.
struct CorrectionFound {
  std::string name;  ///< with the unit
  double off = 0.0, sigma = 0.0;
  double prior = 0.0;  ///< sigma of the given number; 0: it is no finding of its own

  /// Beyond so many sigmas of what is given and of the estimate.
  bool beyond(double sigmas = 3.0) const { return prior > 0.0 && std::abs(off) > sigmas * std::hypot(prior, sigma); }
};

/// The estimated error of a camera's calibration.
struct CalibrationFound {
  std::string camera;
  double rotation_deg = 0.0;    ///< between T_B_C as given and as estimated
  double time_offset_ms = 0.0;  ///< estimated total time offset
  double given_offset_ms = 0.0;
  bool beyond = false;  ///< farther off than the priors estimator.calibration.* allow: wrong, and not corrected
  std::optional<double> rotation_sigma_deg, time_sigma_ms;  ///< sigmas of the estimate; nothing without one
  bool inverse = false;                                     ///< the estimate is the inverse of the given rotation
  std::vector<CorrectionFound> corrections = {};            ///< lens and position; none without an estimate
  bool events = false;  ///< an event camera: the latency of its pixels is part of the time offset

  bool estimated() const { return rotation_sigma_deg && time_sigma_ms; }
};

enum class Fit { Fits, DoesNotFit, CannotBeTold };

struct CameraFit {
  CalibrationFound found;
  Fit fit = Fit::CannotBeTold;
  std::string why;  ///< one line: figures, and the values to write if it does not fit
};

/// The whole calibration: the worst result of its cameras, and other contradictions.
struct CalibrationFit {
  std::vector<CameraFit> cameras;
  std::vector<Finding> findings;  ///< warnings and errors of recording and calibration
  Fit fit = Fit::CannotBeTold;
  std::string why;
};

/// Whether the estimated rotation or clock differs from the given one.
bool is_off(const CalibrationFound& found);

/// found: without sigmas if there is no estimate. findings: those that begin with `camera NAME:` concern that camera,
/// other errors concern all. missing: the last condition that initialization waited for; may be empty.
CalibrationFit judge_fit(const std::vector<CalibrationFound>& found, std::vector<Finding> findings,
                         const std::string& missing);

}  // namespace edged

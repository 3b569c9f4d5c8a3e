// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The online calibration that a run estimated, beside the given one.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "edged/checks/calibration_fit.hpp"
#include "edged/io/calibration.hpp"
#include "edged/odometry.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Covariances of the online calibration, by camera; none without an estimate.
using CalibrationCovariances = std::map<std::string, CalibrationCovariance>;
CalibrationCovariances calibration_covariances(const Odometry& odometry);

/// The errors of the given calibration of each camera, as estimated.
std::vector<CalibrationFound> compare_calibrations(const Rig& given, const Rig& estimated,
                                                   const CalibrationCovariances& covariances,
                                                   const CalibrationConfig& config);

/// Corrections of position and lens: what was estimated of a camera minus what is given.
std::vector<CorrectionFound> corrections_of(const RigCamera& given, const RigCamera& found,
                                            const CalibrationCovariance& P, const CalibrationConfig& config);

/// The given calibration with the cameras as with_estimated of rigs has them.
Calibration with_estimated(Calibration given, const Rig& estimated);

}  // namespace edged

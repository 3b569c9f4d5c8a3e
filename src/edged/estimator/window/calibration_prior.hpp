// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is known of a camera's calibration beforehand, and its corrections as one vector.
#pragma once

#include <span>

#include "edged/estimator/factors/blocks.hpp"
#include "edged/options/estimator.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Standard deviations of the given numbers, as of CalibrationBlock. That of the second coefficient of the lens moves a
/// point at the rim of the image as far as that of the first; zero where the lens has none.
CalibrationVector calibration_sigmas(const CalibrationConfig& config, const CameraModel& given);

/// From the given calibration of a camera to another, as a CalibrationBlock.
CalibrationVector correction_between(const RigCamera& given, const RigCamera& found);

/// The camera with such a correction. A lens that cannot have it keeps the given intrinsics.
RigCamera corrected_camera(const RigCamera& given, const CalibrationVector& correction);

/// An estimate of a correction.
struct CorrectionEstimate {
  CalibrationVector correction;
  CalibrationCovariance covariance;
};

/// Of independent recordings, each estimated from the same prior about zero: their information summed, that of the
/// prior counted once. What was held in a recording stays as in the first. At least one.
CorrectionEstimate combined(std::span<const CorrectionEstimate> estimates, const CalibrationVector& prior_sigmas);

}  // namespace edged

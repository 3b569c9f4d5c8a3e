// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is known of calibrations beforehand: of each camera, and of two to each other, which is far more.
#pragma once

#include <cstddef>
#include <span>

#include "edged/estimator/factors/linear_prior.hpp"
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

/// One of two cameras that are known to each other: its index in the window, its given pose, its present calibration.
struct CameraInPair {
  std::size_t index;
  SE3 T_B_C;
  const CalibrationBlock& calibration;
};

/// All corrections of two cameras behind one lens but the time are equal: those of rotation and lens to 1e-4, of the
/// lever arm to 0.1 mm.
LinearPrior equal_calibrations(const CameraInPair& one, const CameraInPair& other);

/// The rotation between two cameras is as given to relative_rotation_sigma_deg, the baseline, in the frame of the
/// first, to baseline_sigma_mm. Linear in the corrections, which are small.
LinearPrior relative_pose_prior(const CameraInPair& one, const CameraInPair& other, const CalibrationConfig& config);

/// An estimate of a correction.
struct CorrectionEstimate {
  CalibrationVector correction;
  CalibrationCovariance covariance;
};

/// The joint estimate of independent recordings, each estimated from the same prior about zero: their information is
/// summed, that of the prior counted once. What was held in a recording stays as in the first. At least one.
CorrectionEstimate combined(std::span<const CorrectionEstimate> estimates, const CalibrationVector& prior_sigmas);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What is known of the calibrations of two cameras to each other: far more than of each to the IMU.
#pragma once

#include <cstddef>

#include "edged/estimator/factors/linear_prior.hpp"
#include "edged/options/estimator.hpp"
#include "edged/se3.hpp"

namespace edged {

/// One of the two cameras: its index in the window, its pose as given, its calibration now.
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

}  // namespace edged

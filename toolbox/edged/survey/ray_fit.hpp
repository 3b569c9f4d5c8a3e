// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Gyro and camera brought together from the corners themselves, all turns at once.
#pragma once

#include <optional>
#include <span>

#include "edged/survey/gyro_integral.hpp"
#include "edged/survey/visual_turns.hpp"

namespace edged {

/// How the gyro's turning becomes that of a camera.
struct GyroMount {
  Eigen::Matrix3d R_B_C = Eigen::Matrix3d::Identity();
  double shift_s = 0.0;                            ///< t_imu = t_cam + shift
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< as the gyro measures it
  double gyro_scale = 1.0;                         ///< what the gyro says over how fast it turned
};

struct RayFit {
  GyroMount mount;
  Eigen::Matrix3d rotation_covariance = Eigen::Matrix3d::Zero();  ///< of R_B_C * Exp(error) [rad^2]
  double shift_sigma_s = 0.0;
  double unexplained = 1.0;  ///< what turns of their own would explain beyond the gyro's, of what there is to explain
  double scale_sigma = 0.0;  ///< of mount.gyro_scale, with which
  double scale_unexplained = 1.0;  ///< so much stays; all else is as if it were 1
};

/// Where the camera went in a turn, R being that from its end to its begin: of length one, in its axes at the begin.
/// Zero where the corners do not agree which way.
Eigen::Vector3d way_of(const Turn& turn, const Eigen::Matrix3d& R_begin_end);

/// The mount for which the rays of all corners before and after each turn come closest to meeting, whatever the
/// translation of the turn (Gauss-Newton of the cost of Kneip and Lynen, ICCV 2013, over all turns instead of one). A
/// turn of its own hardly tells rotation from translation where the view is narrow or the scene flat; what all have in
/// common is told well. Nothing where turns come without their corners, or the gyro has too little to say.
std::optional<RayFit> fit_rays(std::span<const Turn> turns, const GyroIntegral& gyro, const GyroMount& start);

}  // namespace edged

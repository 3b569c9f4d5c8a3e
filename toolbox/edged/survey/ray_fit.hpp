// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Calibrates gyro against camera from corner rays, over all rotations at once.
#pragma once

#include <optional>
#include <span>

#include "edged/survey/gyro_integral.hpp"
#include "edged/survey/visual_turns.hpp"

namespace edged {

/// The relation of the gyro's rotation to that of a camera.
struct GyroMount {
  Eigen::Matrix3d R_B_C = Eigen::Matrix3d::Identity();
  double shift_s = 0.0;                            ///< t_imu = t_cam + shift
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< as the gyro measures it
  double gyro_scale = 1.0;                         ///< measured over true angular speed
};

struct RayFit {
  GyroMount mount;
  Eigen::Matrix3d rotation_covariance = Eigen::Matrix3d::Zero();  ///< of R_B_C * Exp(error) [rad^2]
  double shift_sigma_s = 0.0;
  double unexplained = 1.0;  ///< share of the cost that independent rotations would explain beyond those of the gyro
  double scale_sigma = 0.0;  ///< of mount.gyro_scale, with which
  double scale_unexplained = 1.0;  ///< unexplained share with it; all else assumes a scale of 1
};

/// Direction of translation in a rotation, R being that from its end to its begin: of length one, in the camera axes at
/// the begin. Zero if the corners do not determine it.
Eigen::Vector3d way_of(const Turn& turn, const Eigen::Matrix3d& R_begin_end);

/// The mount for which the rays of all corners before and after each turn come closest to meeting, whatever the
/// translation of the turn (Gauss-Newton of the cost of Kneip and Lynen, ICCV 2013, over all turns instead of one). A
/// single rotation hardly separates rotation from translation with a narrow view or a flat scene; the common parameters
/// of all are well determined. Nothing if rotations come without corners, or with too little rotation of the gyro.
std::optional<RayFit> fit_rays(std::span<const Turn> turns, const GyroIntegral& gyro, const GyroMount& start);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Compares the rotations of a camera with the gyro: time shift, rotation and scale between the two.
#pragma once

#include <optional>
#include <span>

#include "edged/checks/agreement/accel_agreement.hpp"
#include "edged/checks/agreement/gyro_integral.hpp"
#include "edged/checks/agreement/visual_turns.hpp"

namespace edged {

struct GyroAgreement {
  std::size_t turns = 0;     ///< compared
  Duration turning{0};       ///< turning_time() of them
  double unexplained = 1.0;  ///< share of the rotation; above about 0.5 the other results are unreliable
  Duration time_offset{0};   ///< t_imu = t_cam + time_offset
  double time_sigma_s = 0.0;
  double time_t = 0.0;    ///< Student's t of the tenths of the recording that time_offset fits better than the expected
  bool at_bound = false;  ///< outside the searched range: time_offset is no estimate
  Eigen::Matrix3d R_B_C = Eigen::Matrix3d::Identity();
  double rotation_sigma = 0.0;  ///< sigma of the least certain axis [rad]; large if it rotated about one axis only
  /// Covariance of R_B_C * Exp(error), from the scatter of the estimates of parts of the recording [rad^2].
  Eigen::Matrix3d rotation_covariance = Eigen::Matrix3d::Zero();
  double common_error = 0.0;  ///< error of the rotation shared by all parts, which their scatter does not show [rad]
  bool mirrored = false;      ///< fits only with negated rotations: axes of the gyro have the wrong sign
  double gyro_scale = 1.0;    ///< angular speed of the gyro over that of the camera: 57.3 for deg/s
  double scale_sigma = 0.0;   ///< 0: only units can be determined
  double scale_unexplained = 1.0;  ///< unexplained share with that scale
  AccelAgreement accel;            ///< agreement of the accelerometer over the rotations compared
};

/// Time offsets within kMostShift of `expected` are tried, and farther ones if the best is at that bound. Nothing with
/// too few rotations to compare.
inline constexpr Duration kMostShift = std::chrono::milliseconds(100);
std::optional<GyroAgreement> compare_with_gyro(std::span<const Turn> turns, const GyroIntegral& gyro,
                                               Duration expected);

/// Turns that are too noisy to determine R_B_C still detect a grossly wrong one: the angle to the one found, if that
/// explains the turns clearly better than the calibration, and not by chance, as at rest; else 0.
double grossly_off_deg(std::span<const Turn> turns, const GyroIntegral& gyro, const RigCamera& given,
                       const GyroAgreement& found);

}  // namespace edged

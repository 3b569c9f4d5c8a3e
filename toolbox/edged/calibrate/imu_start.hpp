// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Rotation and clock of a camera against the IMU, from the turns that both saw.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/calibrate/target_view.hpp"
#include "edged/measurement.hpp"

namespace edged {

struct ImuStart {
  Eigen::Quaterniond R_B_C = Eigen::Quaterniond::Identity();
  double time_offset_s = 0.0;  ///< t_imu = t_cam + time_offset
  Eigen::Vector3d bias_gyro = Eigen::Vector3d::Zero();
};

/// From one view to the next that is 20 to 300 ms later: R_C_T(begin) = Exp(angle_C) R_C_T(end).
struct ViewTurn {
  Timestamp begin, end;  ///< camera clock
  Eigen::Vector3d angle_C;
};
std::vector<ViewTurn> view_turns(const TargetViews& camera, const std::vector<std::optional<SE3>>& T_C_T);

/// Searches the clock within a second, first by the length of the turns, then by the turns themselves. Throws
/// InputError that says what to record where the camera hardly turned about an axis, or where its turns are not those
/// of the gyro.
ImuStart align_imu(const TargetViews& camera, const std::vector<std::optional<SE3>>& T_C_T,
                   std::span<const ImuSample> imu);

}  // namespace edged

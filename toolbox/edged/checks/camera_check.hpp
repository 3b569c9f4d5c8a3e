// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The result of the comparison of a camera with the gyro.
#pragma once

#include <optional>

#include "edged/checks/agreement/gyro_agreement.hpp"
#include "edged/checks/agreement/imu_clock.hpp"
#include "edged/rig.hpp"

namespace edged {

struct CameraCheck {
  RigCamera camera;  ///< as calibrated
  bool has_extrinsics = true;
  std::optional<GyroAgreement> agreement;  ///< nothing without enough rotations to compare
  std::optional<ClockRate> clock = {};     ///< if the IMU clock runs at another rate than the camera clock
  Duration least_turning{0};               ///< a contradiction in a shorter turning_time() does not count

  /// True if the gyro explains enough of the rotation for the other results to be reliable.
  bool sure() const { return agreement && agreement->unexplained < 0.5; }
  /// True if the gyro is in deg/s.
  bool in_degrees() const;
};

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a camera and the gyro say of each other.
#pragma once

#include <optional>

#include "edged/rig.hpp"
#include "edged/survey/gyro_agreement.hpp"
#include "edged/survey/imu_clock.hpp"

namespace edged {

struct CameraCheck {
  RigCamera camera;  ///< as calibrated
  bool has_extrinsics = true;
  std::optional<GyroAgreement> agreement;  ///< nothing where there was too little to compare
  std::optional<ClockRate> clock = {};     ///< where the IMU's runs at another rate than the camera's

  /// Whether enough of the turning is explained for the rest to mean something.
  bool sure() const { return agreement && agreement->unexplained < 0.5; }
  /// Whether the gyro is in deg/s.
  bool in_degrees() const;
};

}  // namespace edged

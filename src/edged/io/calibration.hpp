// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The calibration of a sensor head, read from any of the formats its users have.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "edged/camera/rig.hpp"
#include "edged/imu/noise.hpp"
#include "edged/io/source_path.hpp"

namespace edged {

/// Cameras around the IMU, and the noise of the IMU.
struct Calibration {
  Rig rig;
  ImuNoise imu;
  bool has_extrinsics = true;  ///< false: the file has intrinsics only, T_B_C and time_offset are placeholders
  bool has_imu_noise = true;   ///< false: `imu` holds the defaults
};

/// Reads a calibration, the format found by content:
/// - our own yaml (docs/calibration.md, `edged_rig: 1`),
/// - Event-Camera Dataset calib.txt (4 or 9 numbers: intrinsics only, cameras "events" and "frames"; the size is
///   that of the first image beside it, else 240 x 180),
/// - EuRoC: a mav0 folder or its parent, or one sensor.yaml of a camera (with imu0 beside it),
/// - Kalibr camchain-imucam yaml, its IMU noise from imu_file.
/// A folder is searched for calibration.yaml, mav0, camchain*.yaml with imu*.yaml, calib.txt, in that order.
/// Throws InputError for unknown content, a rotation that is not orthonormal, or impossible intrinsics; logs a warning
/// for a lever arm beyond 0.5 m.
Calibration load_calibration(const SourcePath& path, const std::filesystem::path& imu_file = {});

/// A rig by name (config/rigs/NAME.yaml), or by path. Throws InputError that lists the rigs there are.
Calibration load_rig(const std::string& name_or_path);

/// Names of the rigs that load_rig finds, sorted.
std::vector<std::string> known_rigs();

/// Each camera with both directions of its transform and its time offset; the noise of the IMU. Several lines.
std::string describe(const Calibration& calibration);

/// Our own yaml; load_calibration gives back the same numbers to the last bit (rotations to rounding).
std::string to_yaml(const Calibration& calibration);

}  // namespace edged

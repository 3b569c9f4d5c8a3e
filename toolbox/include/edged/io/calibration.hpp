// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The calibration of a sensor head, read from any of the formats its users have.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "edged/input_error.hpp"
#include "edged/io/calibration_data.hpp"

namespace edged {

/// Reads a calibration, the format found by content: ours, Kalibr, EuRoC, Event-Camera Dataset, VINS (ESVIO, HKU),
/// USLAM, basalt, VECtor, ROS camera_info, DV, Metavision. docs/calibration.md has the table: how each is recognised,
/// which way its transforms point, what a folder is searched for, and how a camera is found to see events, frames or
/// both. A lens that gives both becomes two cameras, `events` and `frames`. Throws InputError for unknown content, a
/// rotation that is not orthonormal to 1e-3 or mirrored, impossible intrinsics, and a camera whose modality nothing
/// shows. Logs Calibration::warnings.
Calibration load_calibration(const std::filesystem::path& path, const CalibrationOptions& options = {});

/// A rig by name (core/resources.hpp: rigs/NAME.yaml), or by path. Throws InputError that lists the rigs there are.
Calibration load_rig(const std::string& name_or_path);

/// Names of the rigs that load_rig finds, sorted.
std::vector<std::string> known_rigs();

/// Each camera with its field of view, both directions of its transform and its time offset; the noise of the IMU.
/// Several lines.
std::string describe(const Calibration& calibration);

/// Kalibr's camchain, which load_calibration reads back. has_poses: T_B_C of the cameras relative to each other are
/// known (without extrinsics, B is the first camera). Throws InputError where Kalibr lacks the lens.
std::string to_kalibr_yaml(const Calibration& calibration, bool has_poses);

/// The intrinsics of one camera as OpenCV's samples write them, which load_calibration reads back. Throws InputError
/// where OpenCV lacks the lens.
std::string to_opencv_yaml(const RigCamera& camera);

}  // namespace edged

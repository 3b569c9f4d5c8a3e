// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// What a calibration says of a sensor head, and what its user may say.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edged/imu_noise.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Cameras around the IMU, and the noise of the IMU.
struct Calibration {
  Rig rig;
  ImuNoise imu;
  bool has_extrinsics = true;         ///< false: the file has intrinsics only, T_B_C and time_offset are placeholders
  bool has_imu_noise = true;          ///< false: `imu` holds the defaults
  std::vector<std::string> warnings;  ///< what seems wrong, each one line
  /// Names of cameras, each with the ROS topic that the file names (Kalibr's rostopic); not all need have one.
  std::map<std::string, std::string> topics = {};

  std::optional<ImuNoise> known_noise() const { return has_imu_noise ? std::optional(imu) : std::nullopt; }
};

/// What the pixels behind a lens give: those of a DAVIS give both.
enum class Sees { Events, Frames, Both };

/// "events", "frames" or "both".
std::optional<Sees> parse_sees(std::string_view text);

struct CalibrationOptions {
  std::filesystem::path imu_file = {};  ///< Kalibr imu yaml, instead of what the calibration says of the IMU
  /// By the camera's name in the file: where the file does not state it, or is wrong.
  std::map<std::string, Sees> sees = {};
  std::optional<Sees> otherwise = {};  ///< where nothing shows it; not given: an error that asks
};

/// Our own yaml; load_calibration gives back the same numbers to the last bit (rotations to rounding). Where only
/// lenses are known, FILL_IN stands for the rest, which load_calibration refuses by its line.
std::string to_yaml(const Calibration& calibration);

}  // namespace edged

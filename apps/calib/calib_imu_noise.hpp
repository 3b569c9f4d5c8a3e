// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// `edged calib --imu-noise`: the noise of an IMU from a recording at rest.
#pragma once

#include <filesystem>

#include "common/source.hpp"

namespace edged {

struct CalibImuNoiseOptions {
  SourceOptions source;
  std::filesystem::path out;  ///< for a Kalibr imu yaml
  bool quiet = false, json = false;
};

/// Prints the Allan deviation of each axis and the noise fitted to it, and writes that. Returns the exit code. Throws
/// InputError for a recording that is short or moves.
int measure_imu_noise(const CalibImuNoiseOptions& options);

}  // namespace edged

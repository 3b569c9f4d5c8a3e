// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// IMU samples from a text file of any tool, beside a recording that has none.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "edged/dataset.hpp"
#include "edged/io/text_parsing.hpp"

namespace edged {

/// Where the numbers of an IMU file stand and what they are.
struct ImuTextForm {
  std::size_t t = 0;
  std::array<std::size_t, 3> gyro{}, accel{};
  TimeUnit unit = TimeUnit::Seconds;
  double gyro_scale = 1.0;   ///< to rad/s
  double accel_scale = 1.0;  ///< to m/s^2
  bool named = false;        ///< the columns, by the first line; else gravity tells which they are
  bool guessed = false;      ///< something of all this is not named, but found from the content
  std::string said;          ///< for the user: columns, units, and what of it is a guess
};

/// Columns by the names in the first line; where there is none, seven columns `t gx gy gz ax ay az` or `t ax ay az gx
/// gy gz`, whichever has gravity in the accelerometer. Units by the names, else by the content: gravity, turns faster
/// than sensors measure in rad/s, rates that IMUs have. Throws InputError where that does not decide, with what to
/// write.
ImuTextForm find_imu_form(const SourcePath& file);

/// The recording with the samples of the file instead of its own, if it has any. Both must be on one clock. Throws
/// InputError where they do not overlap, with both spans.
std::unique_ptr<Dataset> with_imu_file(std::unique_ptr<Dataset> recording, const SourcePath& file);

}  // namespace edged

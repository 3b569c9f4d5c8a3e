// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Vectors and rotations in the text of an option.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <string_view>

namespace edged {

/// Three numbers with blanks or commas between them. Throws InputError that names the option `key`.
Eigen::Vector3d three_numbers(const std::string& text, std::string_view key);

/// The rotation R_A_B of axes B whose roll, pitch and yaw in A are these [rad]: first roll about x, then pitch about y,
/// then yaw about z of A.
Eigen::Quaterniond rotation_of(const Eigen::Vector3d& roll_pitch_yaw);

/// rotation_of three numbers in degrees. Throws InputError that names the option `key`.
Eigen::Quaterniond rotation_of_degrees(const std::string& text, std::string_view key);

}  // namespace edged

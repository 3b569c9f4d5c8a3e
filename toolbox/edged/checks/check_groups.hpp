// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The groups of checks. A new check is a function and a row of the table in the source of its group.
#pragma once

#include "edged/checks/checks.hpp"

namespace edged {

/// One check: what it measures, its limits, and its findings. Silent where its sensor is missing.
using Check = void (*)(const CheckInput& input, Findings& out);

void check_streams(const CheckInput& input, Findings& out);
void check_imu(const CheckInput& input, Findings& out);
/// Events and frames of all cameras.
void check_pictures(const CheckInput& input, Findings& out);
/// Height and velocity sensors, in the order of their names.
void check_external(const CheckInput& input, Findings& out);
/// The calibration of each camera, by the gyro. Nothing while it cannot be judged by that.
void check_cameras(const CheckInput& input, Findings& out);
void check_truth(const CheckInput& input, Findings& out);

}  // namespace edged

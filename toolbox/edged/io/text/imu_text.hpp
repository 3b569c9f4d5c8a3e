// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Adds IMU samples from a text file of any tool to a recording.
#pragma once

#include <memory>

#include "edged/dataset.hpp"
#include "edged/io/parse/imu_lines.hpp"

namespace edged {

/// The columns are those of the heading. Without a heading they are `t gx gy gz ax ay az` or `t ax ay az gx gy gz`: the
/// order with gravity in the accelerometer. Units not in the heading are found from the content: gravity, the range of
/// gyros in rad/s, the rates of IMUs. Throws InputError, with the heading to write, if the form is not certain.
ImuTextForm find_imu_form(const SourcePath& file);

/// The recording, with its IMU samples, if any, replaced by those of the file. Both must be on one clock. Throws
/// InputError, with both time spans, if they do not overlap.
std::unique_ptr<Dataset> with_imu_file(std::unique_ptr<Dataset> recording, const SourcePath& file);

}  // namespace edged

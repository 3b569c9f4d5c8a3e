// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// IMU samples from a text file of any tool, beside a recording that has none.
#pragma once

#include <memory>

#include "edged/dataset.hpp"
#include "edged/io/imu_lines.hpp"

namespace edged {

/// Columns by the names in the first line; where there is none, seven columns `t gx gy gz ax ay az` or `t ax ay az gx
/// gy gz`, whichever has gravity in the accelerometer. Units by the names, else by the content: gravity, turns faster
/// than sensors measure in rad/s, rates that IMUs have. Throws InputError where that does not decide, with what to
/// write.
ImuTextForm find_imu_form(const SourcePath& file);

/// The recording with the samples of the file instead of its own, if it has any. Both must be on one clock. Throws
/// InputError where they do not overlap, with both spans.
std::unique_ptr<Dataset> with_imu_file(std::unique_ptr<Dataset> recording, const SourcePath& file);

}  // namespace edged

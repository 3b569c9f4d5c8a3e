// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The ground truth of a recording from a file beside it, such as that of a motion capture system.
#pragma once

#include <memory>

#include "edged/dataset.hpp"
#include "edged/io/archive/source_path.hpp"

namespace edged {

/// The recording with the poses of this file (as read_trajectory reads them, on the recording's clock) as its ground
/// truth, instead of its own. They are of the sensor that the recording's own are of, of the body without any. Throws
/// InputError as read_trajectory().
std::unique_ptr<Dataset> with_truth_file(std::unique_ptr<Dataset> recording, const SourcePath& file);

}  // namespace edged

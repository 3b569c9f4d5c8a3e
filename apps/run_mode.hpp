// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which cameras of the calibration a run uses.
#pragma once

#include "edged/pipeline/mode.hpp"
#include "source.hpp"

namespace edged {

/// Calls the cameras that the mode needs as the recording does, and warns of what it had to assume for that. Throws
/// InputError where it cannot be known.
void match_cameras(Source& source, Mode mode);

}  // namespace edged

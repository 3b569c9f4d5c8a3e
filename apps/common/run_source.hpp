// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens the recording of a run and chooses its cameras: two of a kind where their views overlap.
#pragma once

#include "common/source.hpp"

namespace edged {

/// Opens the recording with the cameras that options.cameras names, else with those of stereo_cameras(), which it puts
/// there; of a live source, of the simulator, and where not all cameras can be read, with the first of each kind.
/// Throws as open_source().
Source open_run_source(SourceOptions& options);

}  // namespace edged

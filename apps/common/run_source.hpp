// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Opens the recording of a run and chooses its cameras: two of a kind where their views overlap.
#pragma once

#include <string>
#include <vector>

#include "common/source.hpp"

namespace edged {

/// The cameras of a run by default: of each kind that the recording delivers the first, and one more of the rig whose
/// view overlaps the first one's. Empty where there is none of these: then the first of each kind are used.
std::vector<std::string> stereo_cameras(const Rig& rig, const DatasetInfo& info);

/// Opens the recording with the cameras that options.cameras names, else with those of stereo_cameras(), which it puts
/// there; of a live source, of the simulator, and where not all cameras can be read, with the first of each kind.
/// Throws as open_source().
Source open_run_source(SourceOptions& options);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Chooses the cameras of a run: two of a kind where their views overlap.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "edged/io/recording.hpp"

namespace edged {

/// The cameras of a run by default: of each kind that the recording delivers the first, and one more of the rig whose
/// view overlaps the first one's. Empty where there is none of these: then the first of each kind are used.
std::vector<std::string> stereo_cameras(const Rig& rig, const DatasetInfo& info);

/// Opens a recording with these cameras, else all, else the first of each kind.
using OpenCameras = std::function<Recording(const std::vector<std::string>& cameras, bool all)>;

/// Opens a recording with the cameras of stereo_cameras(), which it puts into `cameras`; where there are none and where
/// not all cameras can be read, with the first of each kind. Throws as `open`.
Recording open_with_stereo_cameras(const OpenCameras& open, std::vector<std::string>& cameras);

}  // namespace edged

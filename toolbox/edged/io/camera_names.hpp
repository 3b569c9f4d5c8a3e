// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Assigns the cameras of a recording to the cameras of a rig.
#pragma once

#include <string>

#include "edged/dataset.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Assigns the camera of the recording of this modality to a camera of the rig: the one of the same name, else the only
/// one of the modality. Renames that camera to the name in the recording, which ground truth and output frames use, so
/// that Rig::find returns it. Returns the assumption in one line, empty if the names agree. Throws InputError, with the
/// cameras of both, if no camera or several fit.
std::string match_camera(Rig& rig, const DatasetInfo& info, Modality modality);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Which camera of a rig a recording's events or frames are of.
#pragma once

#include <string>

#include "edged/dataset.hpp"
#include "edged/rig.hpp"

namespace edged {

/// Makes the camera of this kind that the recording has the one that Rig::find gives, under the recording's name for it
/// (ground truth and output frames go by that name): the one so called, else the only one of the kind. What was
/// assumed, in one line; empty where the names agree. Throws InputError with both lists where there is none, or
/// several.
std::string match_camera(Rig& rig, const DatasetInfo& info, Modality modality);

}  // namespace edged

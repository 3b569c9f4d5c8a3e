// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The text folders of the Event-Camera Dataset and of UZH-FPV.
#pragma once

#include "edged/io/archive/source_path.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// folder: is_ecd_folder() is true for it.
Recording open_ecd(const SourcePath& folder, const Rig* rig, const RecordingOptions& options);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The ASL folders of EuRoC and TUM-VI.
#pragma once

#include "edged/io/archive/source_path.hpp"
#include "edged/io/recording.hpp"

namespace edged {

/// mav0: as returned by find_mav0().
Recording open_euroc(const SourcePath& mav0, const RecordingOptions& options);

}  // namespace edged

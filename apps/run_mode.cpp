// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "run_mode.hpp"

#include <spdlog/spdlog.h>

#include "edged/io/camera_names.hpp"

namespace edged {

void match_cameras(Source& source, Mode mode) {
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    if (!uses(mode, modality)) continue;
    const std::string assumed = match_camera(source.calibration.rig, source.dataset->info(), modality);
    if (!assumed.empty()) spdlog::warn(assumed);
  }
}

}  // namespace edged

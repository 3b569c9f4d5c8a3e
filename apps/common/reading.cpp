// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "common/reading.hpp"

#include <algorithm>

#include "common/interrupt.hpp"
#include "common/status_line.hpp"
#include "edged/core/measurements/measurement_stamps.hpp"

namespace edged {

void read_through(Dataset& dataset, bool quiet, std::string_view what,
                  const std::function<bool(const Measurement&)>& use) {
  StatusLine status(quiet);
  InterruptibleDataset recording(dataset);
  while (const std::optional<Measurement> measurement = recording.next()) {
    if (!use(*measurement)) return;
    if (const auto t = last_stamp(*measurement)) show_progress(status, *t, dataset.info(), what);
  }
}

std::vector<RigCamera> calibrated_cameras(const Recording& recording) {
  std::vector<RigCamera> cameras;
  const DatasetInfo& info = recording.dataset->info();
  if (!info.has_imu) return cameras;
  const Rig& rig = recording.calibration->rig;
  for (const RecordedCamera& recorded : recorded_cameras(info)) {
    const auto named = std::ranges::find(rig.cameras, recorded.name, &RigCamera::name);
    const bool known = named != rig.cameras.end() && named->modality == recorded.modality;
    const bool first = recorded.name == info.event_camera || recorded.name == info.frame_camera;
    const RigCamera* camera = known ? &*named : first ? rig.find(recorded.modality) : nullptr;
    if (!camera) continue;
    cameras.push_back(*camera);
    cameras.back().name = recorded.name;
  }
  return cameras;
}

}  // namespace edged

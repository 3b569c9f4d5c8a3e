// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/dataset.hpp"

#include <algorithm>

namespace edged {

std::vector<RecordedCamera> recorded_cameras(const DatasetInfo& info) {
  std::vector<RecordedCamera> cameras;
  const auto add = [&](bool there, Modality modality, const std::string& name, cv::Size sensor) {
    if (!there) return;
    const std::string kind = modality == Modality::Events ? "events" : "frames";
    const auto stream =
        std::ranges::find_if(info.streams, [&](const StreamInfo& s) { return s.role == name || s.role == kind; });
    cameras.push_back({name, modality, stream == info.streams.end() ? "" : stream->name, sensor});
    std::ranges::copy_if(info.more_cameras, std::back_inserter(cameras),
                         [modality](const RecordedCamera& camera) { return camera.modality == modality; });
  };
  add(info.has_events, Modality::Events, info.event_camera, info.event_sensor);
  add(info.has_frames, Modality::Frames, info.frame_camera, {});
  return cameras;
}

}  // namespace edged

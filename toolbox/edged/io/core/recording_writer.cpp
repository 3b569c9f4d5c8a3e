// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/core/recording_writer.hpp"

#include <algorithm>

#include "edged/core/check.hpp"
#include "edged/io/core/camera_names.hpp"

namespace edged {

std::vector<RecordedCamera> WriterSetup::of_kind(Modality modality) const {
  std::vector<RecordedCamera> cameras = recorded_cameras(info);
  std::erase_if(cameras, [modality](const RecordedCamera& camera) { return camera.modality != modality; });
  return cameras;
}

cv::Size WriterSetup::event_sensor(std::size_t camera) const {
  const Rig* rig = calibration ? &calibration->rig : nullptr;
  const std::vector<RecordedCamera> events = of_kind(Modality::Events);
  const std::string name = camera < events.size() ? events[camera].name : info.event_camera;
  const cv::Size size = camera < events.size() ? events[camera].sensor : info.event_sensor;
  return event_sensor_size(info.name, size.empty() ? std::nullopt : std::optional(size), rig, name);
}

std::size_t WriterSetup::cameras(Modality modality) const { return std::max<std::size_t>(of_kind(modality).size(), 1); }

std::size_t WriterSetup::place_of(const std::string& camera, Modality modality) const {
  const std::vector<RecordedCamera> known = of_kind(modality);
  if (known.size() < 2) return 0;
  const auto found = std::ranges::find(known, camera, &RecordedCamera::name);
  if (found == known.end())
    throw InputError::format("{}: camera '{}' is not among those that the recording names", info.name, camera);
  return static_cast<std::size_t>(found - known.begin());
}

Calibration WriterSetup::calibration_when_read() const {
  Calibration renamed = calibration.value();
  renamed.topics.clear();  // of the container that was read
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    std::vector<RigCamera*> rest;
    for (RigCamera& camera : renamed.rig.cameras)
      if (camera.modality == modality) rest.push_back(&camera);
    std::vector<std::string> taken;
    for (const RecordedCamera& recorded : of_kind(modality)) {
      auto camera = std::ranges::find(rest, recorded.name, [](const RigCamera* c) { return c->name; });
      if (camera == rest.end() && taken.empty()) camera = rest.begin();  // the first of its kind by any name
      taken.push_back(usual_camera_name(modality, taken.size()));
      if (camera == rest.end()) continue;
      (*camera)->name = taken.back();
      rest.erase(camera);
    }
    for (RigCamera* camera : rest) {
      for (std::size_t i = 0; std::ranges::find(taken, camera->name) != taken.end(); ++i)
        camera->name = usual_camera_name(modality, i);
      taken.push_back(camera->name);
    }
  }
  return renamed;
}

std::string WriterSetup::name_when_read(const std::string& frame) const {
  for (const Modality modality : {Modality::Events, Modality::Frames}) {
    const std::vector<RecordedCamera> cameras = of_kind(modality);
    const auto found = std::ranges::find(cameras, frame, &RecordedCamera::name);
    if (found != cameras.end()) return usual_camera_name(modality, static_cast<std::size_t>(found - cameras.begin()));
  }
  if (calibration) {
    const std::vector<RigCamera>& cameras = calibration->rig.cameras;
    const auto known = std::ranges::find(cameras, frame, &RigCamera::name);
    if (known != cameras.end())
      return calibration_when_read().rig.cameras[static_cast<std::size_t>(known - cameras.begin())].name;
  }
  return frame;
}

}  // namespace edged

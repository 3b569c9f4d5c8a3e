// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/recording_writer.hpp"

#include "edged/io/geometry.hpp"

namespace edged {

cv::Size WriterSetup::event_sensor() const {
  const Rig* rig = calibration ? &calibration->rig : nullptr;
  const std::optional<cv::Size> said = info.event_sensor.empty() ? std::nullopt : std::optional(info.event_sensor);
  return event_sensor_size(info.name, said, rig);
}

std::string WriterSetup::name_when_read(const std::string& frame) const {
  if (calibration)
    for (const RigCamera& camera : calibration->rig.cameras)
      if (camera.name == frame) return camera.modality == Modality::Events ? "events" : "frames";
  return frame;
}

}  // namespace edged

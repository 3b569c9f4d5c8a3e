// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/camera/output_frame.hpp"

#include <spdlog/fmt/fmt.h>

#include "edged/camera/field_of_view.hpp"

namespace edged {

Rig with_estimated(const Rig& given, const Rig& estimated) {
  Rig found = given;
  for (RigCamera& camera : found.cameras) {
    for (const RigCamera& calibrated : estimated.cameras) {
      if (!is_same_lens(given.camera(camera.name), given.camera(calibrated.name))) continue;
      camera.model = calibrated.model;
      camera.T_B_C = calibrated.T_B_C;
      if (camera.name == calibrated.name) camera.time_offset = calibrated.time_offset;
    }
  }
  return found;
}

Rig rig_for_poses(const Rig& given, const Rig& estimated) {
  Rig found = with_estimated(given, estimated);
  for (RigCamera& camera : found.cameras)
    if (camera.modality == Modality::Events) camera.time_offset = given.camera(camera.name).time_offset;
  return found;
}

OutputFrame::OutputFrame(const Rig& rig, const std::string& name) : name_(name) {
  if (name == "body") return;
  const RigCamera& camera = rig.camera(name);
  T_B_X_ = camera.T_B_C;
  time_offset_ = camera.time_offset;
}

Trajectory OutputFrame::operator()(const Trajectory& body) const {
  Trajectory result;
  result.reserve(body.size());
  for (const StampedPose& pose : body) result.push_back((*this)(pose));
  return result;
}

std::string OutputFrame::describe() const {
  if (name_ == "body") return "pose T_W_B of the body (IMU) in the world (z up), stamps on the IMU clock";
  return fmt::format(
      "pose T_W_C of camera '{}' in the world (z up), stamps on that camera's clock (t_imu = t_cam + {} ns)", name_,
      time_offset_.count());
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/estimator/window/camera_poses.hpp"

namespace edged {
namespace {

std::vector<SE3> present_poses(const Window& window) {
  std::vector<SE3> poses;
  for (const auto& [id, state] : window.states()) poses.push_back(state.T_O_B());
  return poses;
}

}  // namespace

CameraPoses::CameraPoses(const Window& window) : CameraPoses(window, present_poses(window)) {}

CameraPoses::CameraPoses(const Window& window, const std::vector<SE3>& poses)
    : states_(poses.size()), moved_(poses.size(), Vector6d::Zero()) {
  views_.reserve(window.cameras().size() * states_);
  for (const WindowCamera& by : window.cameras()) {
    const CameraOnBody& camera = cameras_.emplace_back(by.given.T_B_C, by.calibration.data());
    std::size_t place = 0;
    for (const auto& [id, state] : window.states()) views_.emplace_back(camera, poses[place++], state.rate());
  }
}

CameraPoses CameraPoses::at_first_estimates(const Window& window) {
  std::vector<SE3> poses;
  std::vector<Vector6d> moved;
  for (const auto& [id, state] : window.states()) {
    const double* pose = window.linearisation_point({BlockKind::Pose, id});
    poses.push_back(pose_of(pose));
    tangent_difference(BlockKind::Pose, state.pose.data(), pose, moved.emplace_back().data());
  }
  CameraPoses views(window, poses);
  views.moved_ = std::move(moved);
  return views;
}

}  // namespace edged

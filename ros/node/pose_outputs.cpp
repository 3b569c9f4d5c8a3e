// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/pose_outputs.hpp"

#include <algorithm>
#include <chrono>

namespace edged::node {
namespace {

constexpr std::size_t kPoseQueue = 100;         // messages that may wait for a slow subscriber
constexpr std::size_t kMostPathPoses = 36'000;  // an hour by the default distance
constexpr Duration kPathPeriod = std::chrono::milliseconds(500), kCamerasPeriod = std::chrono::seconds(1);
constexpr double kCameraStep_m = 1e-3, kCameraStep_rad = 1e-3;  // worth another message for the online calibration

bool has_moved(const SE3& before, const SE3& now) {
  return (before.translation() - now.translation()).norm() > kCameraStep_m ||
         before.rotation().angularDistance(now.rotation()) > kCameraStep_rad;
}

}  // namespace

PoseOutputs::PoseOutputs(Transport& transport, const NodeConfig& config)
    : format_{transport.wire(), config.frames},
      publish_tf_(config.publish_tf),
      odometry_(transport.advertise({"~/odometry", "nav_msgs/Odometry", kPoseQueue})),
      pose_(transport.advertise({"~/pose", "geometry_msgs/PoseWithCovarianceStamped", kPoseQueue})),
      path_topic_(transport.advertise({"~/path", "nav_msgs/Path", 1})),
      transforms_(transport.advertise({"/tf", "tf2_msgs/TFMessage", kPoseQueue})),
      static_transforms_(transport.advertise({"/tf_static", "tf2_msgs/TFMessage", 1, true})),
      path_step_(duration_from_seconds(config.path_step_s)),
      path_message_(kPathPeriod),
      cameras_message_(kCamerasPeriod) {}

void PoseOutputs::publish(const Estimate& estimate) {
  odometry_->publish(odometry_message(format_, estimate));
  pose_->publish(pose_message(format_, estimate));
  if (publish_tf_) transforms_->publish(body_transform_message(format_, estimate.state));
  extend_path(estimate.state);
}

void PoseOutputs::extend_path(const NavState& state) {
  if (path_step_.begins(state.t)) {
    if (path_.size() >= kMostPathPoses) path_.pop_front();
    path_.push_back({state.t, state.T_W_B});
  }
  if (path_message_.begins(state.t) && path_topic_->wanted())
    path_topic_->publish(path_message(format_, state.t, path_));
}

void PoseOutputs::publish_cameras(Timestamp t, const Rig& rig) {
  const auto is_changed = [this](const RigCamera& camera) {
    const auto sent = sent_cameras_.find(camera.name);
    return sent == sent_cameras_.end() || has_moved(sent->second, camera.T_B_C);
  };
  if (!publish_tf_ || !cameras_message_.is_over(t) || std::ranges::none_of(rig.cameras, is_changed)) return;
  cameras_message_.begins(t);
  for (const RigCamera& camera : rig.cameras) sent_cameras_[camera.name] = camera.T_B_C;
  static_transforms_->publish(camera_transforms_message(format_, t, rig));
}

}  // namespace edged::node

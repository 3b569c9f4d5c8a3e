// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/pose_outputs.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

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

PoseOutputs::PoseOutputs(Transport& transport, const NodeConfig& config, const std::optional<SE3>& T_base_B)
    : format_{transport.wire(), config.frame_names()},
      publish_tf_(config.publish_tf),
      T_base_B_(T_base_B),
      odometry_(transport.advertise({"~/odometry", "nav_msgs/Odometry", kPoseQueue})),
      pose_(transport.advertise({"~/pose", "geometry_msgs/PoseWithCovarianceStamped", kPoseQueue})),
      path_topic_(transport.advertise({"~/path", "nav_msgs/Path", 1})),
      transforms_(transport.advertise({"/tf", "tf2_msgs/TFMessage", kPoseQueue})),
      static_transforms_(transport.advertise({"/tf_static", "tf2_msgs/TFMessage", 1, true})),
      path_step_(duration_from_seconds(config.path_step_s)),
      path_message_(kPathPeriod),
      cameras_message_(kCamerasPeriod) {}

void PoseOutputs::publish(const Estimate& in_map, const SE3& T_map_odom) {
  const Estimate in_odom = in(T_map_odom.inverse(), in_map);
  odometry_->publish(odometry_message(format_, in_odom));
  pose_->publish(pose_message(format_, in_map));
  const FrameNames& names = format_.frames;
  const std::array<FrameTransform, 2> tree{
      {{names.map, names.odom, T_map_odom}, {names.odom, names.base, in_odom.state.T_W_B}}};
  if (publish_tf_) transforms_->publish(transforms_message(format_.wire, in_map.state.t, tree));
  extend_path(in_map.state);
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
  const FrameNames& names = format_.frames;
  std::vector<FrameTransform> transforms;
  if (T_base_B_) transforms.push_back({names.base, names.body, *T_base_B_});
  for (const RigCamera& camera : rig.cameras) {
    sent_cameras_[camera.name] = camera.T_B_C;
    transforms.push_back({names.body, names.prefix + camera.name, camera.T_B_C});
  }
  static_transforms_->publish(transforms_message(format_.wire, t, transforms));
}

}  // namespace edged::node

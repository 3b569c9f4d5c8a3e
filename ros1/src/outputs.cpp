// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "outputs.hpp"

namespace edged::ros1 {
namespace {

constexpr std::uint32_t kQueue = 100, kImuQueue = 1000, kImageQueue = 2;  // messages that may wait for a slow listener
constexpr std::size_t kMostPathPoses = 36'000;                            // an hour by the default distance
constexpr Duration kPathPeriod = std::chrono::milliseconds(500);

}  // namespace

Outputs::Outputs(ros::NodeHandle& node, const NodeConfig& config)
    : frames_(config.frames),
      publish_tf_(config.publish_tf),
      path_step_(duration_from_seconds(config.path_step_s)),
      odometry_(node.advertise<nav_msgs::Odometry>("odometry", kQueue)),
      prediction_(node.advertise<nav_msgs::Odometry>("prediction", kImuQueue)),
      pose_(node.advertise<geometry_msgs::PoseWithCovarianceStamped>("pose", kQueue)),
      path_topic_(node.advertise<nav_msgs::Path>("path", 1, true)),
      transforms_(node.advertise<tf2_msgs::TFMessage>("/tf", kQueue)),
      landmarks_(node.advertise<sensor_msgs::PointCloud2>("landmarks", kImageQueue)),
      frame_tracks_(node.advertise<sensor_msgs::Image>("tracks/frames", kImageQueue)),
      event_tracks_(node.advertise<sensor_msgs::Image>("tracks/events", kImageQueue)),
      diagnostics_(node.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", kQueue)) {
  path_.header.frame_id = frames_.world;
}

void Outputs::publish(const Step& step, const Eigen::Vector3d& gyro_B, const Rig& rig) {
  publish_images(step);
  if (!is_tracking(step.status)) return;
  publish_pose(step, gyro_B, rig);
  if (!step.landmarks.empty() && landmarks_.getNumSubscribers() > 0)
    landmarks_.publish(landmarks_message(step.t, step.landmarks, frames_));
}

void Outputs::publish_pose(const Step& step, const Eigen::Vector3d& gyro_B, const Rig& rig) {
  const nav_msgs::Odometry odometry = odometry_message(step.state, gyro_B, step.covariance, frames_);
  odometry_.publish(odometry);
  pose_.publish(pose_message(odometry));
  if (publish_tf_) transforms_.publish(transforms_message(step.state, rig, frames_));
  extend_path(step.t, odometry);
}

void Outputs::extend_path(Timestamp t, const nav_msgs::Odometry& odometry) {
  if (!path_end_ || t - *path_end_ >= path_step_) {
    if (path_.poses.size() >= kMostPathPoses) path_.poses.erase(path_.poses.begin());
    path_.poses.push_back(stamped_pose_message(odometry));
    path_end_ = t;
  }
  if (path_sent_ && t - *path_sent_ < kPathPeriod) return;
  path_.header.stamp = odometry.header.stamp;
  path_topic_.publish(path_);
  path_sent_ = t;
}

void Outputs::publish_images(const Step& step) const {
  for (const CameraStep& camera : step.cameras) {
    const auto other = other_tracks_.find(camera.name);
    const ros::Publisher& publisher = other != other_tracks_.end()          ? other->second
                                      : camera.modality == Modality::Events ? event_tracks_
                                                                            : frame_tracks_;
    if (!camera.image.empty() && publisher.getNumSubscribers() > 0)
      publisher.publish(tracks_message(step.t, camera.name, camera.image, camera.tracks));
  }
}

void Outputs::add_camera(ros::NodeHandle& node, const std::string& name) {
  other_tracks_[name] = node.advertise<sensor_msgs::Image>("tracks/" + name, kImageQueue);
}

void Outputs::publish_prediction(const NavState& state, const Eigen::Vector3d& gyro_B,
                                 const std::optional<StateCovariance>& covariance) const {
  prediction_.publish(odometry_message(state, gyro_B, covariance, frames_));
}

void Outputs::publish(const diagnostic_msgs::DiagnosticStatus& status) const {
  diagnostic_msgs::DiagnosticArray message;
  message.header.stamp = ros::Time::now();
  message.status.push_back(status);
  diagnostics_.publish(message);
}

}  // namespace edged::ros1

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/outputs.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <utility>

#include "edged/core/check.hpp"

namespace edged::node {
namespace {

constexpr std::size_t kQueue = 100, kImuQueue = 200, kImageQueue = 2;  // messages that may wait for a slow listener
constexpr std::size_t kMostMapPoints = 20'000;
constexpr double kMostCells = 16e6;             // of the occupancy grid: 200 m by 200 m in voxels of 5 cm
constexpr std::size_t kMostPathPoses = 36'000;  // an hour by the default distance
constexpr Duration kPathPeriod = std::chrono::milliseconds(500), kCamerasPeriod = std::chrono::seconds(1),
                   kMapPeriod = std::chrono::seconds(2);
constexpr double kCameraStep_m = 1e-3, kCameraStep_rad = 1e-3;  // worth another message for the online calibration

bool has_moved(const SE3& before, const SE3& now) {
  return (before.translation() - now.translation()).norm() > kCameraStep_m ||
         before.rotation().angularDistance(now.rotation()) > kCameraStep_rad;
}

}  // namespace

Outputs::Outputs(Transport& transport, const NodeConfig& config)
    : transport_(transport),
      wire_(transport.wire()),
      frames_(config.frames),
      publish_tf_(config.publish_tf),
      path_step_(duration_from_seconds(config.path_step_s)),
      odometry_(transport.advertise({"~/odometry", "nav_msgs/Odometry", kQueue})),
      prediction_(transport.advertise({"~/prediction", "nav_msgs/Odometry", kImuQueue})),
      pose_(transport.advertise({"~/pose", "geometry_msgs/PoseWithCovarianceStamped", kQueue})),
      path_topic_(transport.advertise({"~/path", "nav_msgs/Path", 1})),
      transforms_(transport.advertise({"/tf", "tf2_msgs/TFMessage", kQueue})),
      static_transforms_(transport.advertise({"/tf_static", "tf2_msgs/TFMessage", 1, true})),
      landmarks_(transport.advertise({"~/landmarks", "sensor_msgs/PointCloud2", kImageQueue})),
      map_(transport.advertise({"~/map", "sensor_msgs/PointCloud2", 1})),
      diagnostics_(transport.advertise({"/diagnostics", "diagnostic_msgs/DiagnosticArray", kQueue})),
      map_points_(kMostMapPoints) {
  if (config.occupancy.voxel_m > 0.0) make_occupancy(config.occupancy);
}

void Outputs::make_occupancy(const OccupancyGridConfig& config) {
  const bool of_path = config.low_m == 0.0 && config.high_m == 0.0;
  if (!of_path && config.low_m >= config.high_m)
    throw InputError::format("occupancy.low_m {:g}: must be below occupancy.high_m {:g}", config.low_m, config.high_m);
  grid_ = transport_.advertise({"~/occupancy", "nav_msgs/OccupancyGrid", 1, true});
  octomap_ = transport_.advertise({"~/octomap", "octomap_msgs/Octomap", 1, true});
  const auto show = [this, config, of_path](const OccupancyMap& map) {
    if (map.left_out > 0 && !std::exchange(told_left_out_, true))
      spdlog::warn(
          "occupancy map: keyframes are left out, as it is too large or made too slowly; choose a larger "
          "occupancy.voxel_m");
    octomap_->publish(octomap_message(wire_, map.t, map.tree, frames_));
    const HeightRange heights = of_path ? HeightRange{map.path.low_m - config.voxel_m, map.path.high_m + config.voxel_m}
                                        : HeightRange{config.low_m, config.high_m};
    try {
      if (const auto slice = slice_of(map.tree, heights, kMostCells))
        grid_->publish(occupancy_message(wire_, map.t, *slice, config.voxel_m, frames_));
    } catch (const InputError& e) {
      if (!std::exchange(grid_too_large_, true)) spdlog::warn(fmt::format("occupancy grid: {}", e.what()));
    }
  };
  occupancy_ = std::make_unique<OccupancyWorker>(config.voxel_m, config.period_s, show);
}

void Outputs::add_camera(const std::string& name, const std::string& topic) {
  tracks_[name] = transport_.advertise({"~/tracks/" + topic, "sensor_msgs/Image", kImageQueue});
}

void Outputs::publish_cameras(Timestamp t, const Rig& rig) {
  const bool again = !cameras_sent_ || t < *cameras_sent_ || t - *cameras_sent_ >= kCamerasPeriod;
  if (!publish_tf_ || !again) return;
  bool changed = false;
  for (const RigCamera& camera : rig.cameras) {
    const auto sent = sent_cameras_.find(camera.name);
    changed = changed || sent == sent_cameras_.end() || has_moved(sent->second, camera.T_B_C);
  }
  if (!changed) return;
  cameras_sent_ = t;
  for (const RigCamera& camera : rig.cameras) sent_cameras_[camera.name] = camera.T_B_C;
  static_transforms_->publish(camera_transforms_message(wire_, t, rig, frames_));
}

void Outputs::publish(const Step& step, const Eigen::Vector3d& gyro_B) {
  publish_images(step);
  if (!is_tracking(step.status)) return;
  publish_pose({step.state, gyro_B, step.covariance});
  if (!step.landmarks.empty() && landmarks_->wanted())
    landmarks_->publish(landmarks_message(wire_, step.t, step.landmarks, frames_));
  if (step.keyframe) map_points_.add(step.landmarks);
  if (occupancy_) occupancy_->add(step.marginalized_keyframes);
  publish_map(step.t);
}

void Outputs::publish_map(Timestamp t) {
  const bool due = !map_sent_ || t < *map_sent_ || t - *map_sent_ >= kMapPeriod;
  if (!due || map_points_.all().empty() || !map_->wanted()) return;
  map_sent_ = t;
  std::vector<Landmark> points;
  for (const auto& [id, p] : map_points_.all()) points.push_back({id, Eigen::Vector3d(p[0], p[1], p[2])});
  map_->publish(landmarks_message(wire_, t, points, frames_));
}

void Outputs::publish_pose(const Estimate& estimate) {
  odometry_->publish(odometry_message(wire_, estimate, frames_));
  pose_->publish(pose_message(wire_, estimate, frames_));
  if (publish_tf_) transforms_->publish(body_transform_message(wire_, estimate.state, frames_));
  extend_path(estimate.state);
}

void Outputs::extend_path(const NavState& state) {
  if (path_.empty() || state.t < path_.back().t || state.t - path_.back().t >= path_step_) {
    if (path_.size() >= kMostPathPoses) path_.pop_front();
    path_.push_back({state.t, state.T_W_B});
  }
  if (path_sent_ && state.t >= *path_sent_ && state.t - *path_sent_ < kPathPeriod) return;
  path_sent_ = state.t;
  if (path_topic_->wanted()) path_topic_->publish(path_message(wire_, state.t, path_, frames_));
}

void Outputs::publish_images(const Step& step) const {
  for (const CameraStep& camera : step.cameras) {
    const auto topic = tracks_.find(camera.name);
    if (topic != tracks_.end() && !camera.image.empty() && topic->second->wanted())
      topic->second->publish(tracks_message(wire_, step.t, camera));
  }
}

void Outputs::publish_prediction(const Estimate& estimate) const {
  prediction_->publish(odometry_message(wire_, estimate, frames_));
}

void Outputs::publish(const Diagnosis& diagnosis, const std::string& hardware) const {
  diagnostics_->publish(diagnostics_message(wire_, transport_.now(), hardware, diagnosis));
}

}  // namespace edged::node

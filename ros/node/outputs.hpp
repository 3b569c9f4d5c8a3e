// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The topics that the node publishes.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <string>

#include "edged/live/seen_points.hpp"
#include "edged/occupancy/occupancy_worker.hpp"
#include "node/messages.hpp"
#include "node/transport.hpp"

namespace edged::node {

/// Images, landmarks and the path are made only for subscribers. The occupancy map, as a grid and as voxels, is made in
/// a thread of its own, and kept for those who subscribe later.
class Outputs {
 public:
  /// Throws InputError for heights of the grid in the wrong order.
  Outputs(Transport& transport, const NodeConfig& config);

  /// Advertises the tracked images of a camera. topic: "events", "frames", or its name.
  void add_camera(const std::string& name, const std::string& topic);
  /// The cameras of the mode as calibrated; again, but not often, after their online calibration has changed.
  void publish_cameras(Timestamp t, const Rig& rig);

  /// Of one packet; gyro_B: measured at that time.
  void publish(const Step& step, const Eigen::Vector3d& gyro_B);
  /// At an IMU sample. From another thread than the rest.
  void publish_prediction(const Estimate& estimate) const;
  void publish(const Diagnosis& diagnosis, const std::string& hardware) const;

 private:
  void publish_pose(const Estimate& estimate);
  void publish_images(const Step& step) const;
  void extend_path(const NavState& state);
  void publish_map(Timestamp t);
  void make_occupancy(const OccupancyGridConfig& config);

  Transport& transport_;
  const Wire wire_;
  const FrameNames frames_;
  const bool publish_tf_;
  const Duration path_step_;
  std::unique_ptr<Publisher> odometry_, prediction_, pose_, path_topic_, transforms_, static_transforms_, landmarks_,
      map_, diagnostics_;
  std::map<std::string, std::unique_ptr<Publisher>> tracks_;  ///< by camera
  SeenPoints map_points_;
  std::optional<Timestamp> map_sent_;
  std::deque<StampedPose> path_;
  std::optional<Timestamp> path_sent_;
  std::map<std::string, SE3> sent_cameras_;  ///< T_B_C
  std::optional<Timestamp> cameras_sent_;    ///< stamp
  std::unique_ptr<Publisher> grid_, octomap_;
  bool grid_too_large_ = false, told_left_out_ = false;  ///< that has been reported
  std::unique_ptr<OccupancyWorker> occupancy_;  ///< may be none; its thread alone publishes the two. Last member
};

}  // namespace edged::node

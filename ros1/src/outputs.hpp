// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The topics that the node publishes.
#pragma once

#include <nav_msgs/Path.h>
#include <ros/node_handle.h>

#include <map>
#include <string>

#include "diagnostics.hpp"
#include "messages.hpp"

namespace edged::ros1 {

/// Images, landmarks and the path are made only for subscribers.
class Outputs {
 public:
  Outputs(ros::NodeHandle& node, const NodeConfig& config);

  /// Advertises tracks/NAME of a camera beside the first of its kind.
  void add_camera(ros::NodeHandle& node, const std::string& name);

  /// Of one packet; rig: the cameras of the mode with online calibration.
  void publish(const Step& step, const Eigen::Vector3d& gyro_B, const Rig& rig);
  /// At an IMU sample; covariance: of the newest packet. From another thread than the rest.
  void publish_prediction(const NavState& state, const Eigen::Vector3d& gyro_B,
                          const std::optional<StateCovariance>& covariance) const;
  void publish(const diagnostic_msgs::DiagnosticStatus& status) const;

 private:
  void publish_pose(const Step& step, const Eigen::Vector3d& gyro_B, const Rig& rig);
  void publish_images(const Step& step) const;
  void extend_path(Timestamp t, const nav_msgs::Odometry& odometry);

  const FrameNames frames_;
  const bool publish_tf_;
  const Duration path_step_;
  ros::Publisher odometry_, prediction_, pose_, path_topic_, transforms_, landmarks_, frame_tracks_, event_tracks_,
      diagnostics_;
  std::map<std::string, ros::Publisher> other_tracks_;  ///< by camera
  nav_msgs::Path path_;
  std::optional<Timestamp> path_end_, path_sent_;
};

}  // namespace edged::ros1

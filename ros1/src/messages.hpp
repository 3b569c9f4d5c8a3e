// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The results of the odometry as ROS messages.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/rig.hpp"
#include "edged/step.hpp"
#include "node_config.hpp"

namespace edged::ros1 {

/// Stamps that ROS cannot hold become its first or last one.
ros::Time to_ros(Timestamp t);
geometry_msgs::Pose to_ros(const SE3& pose);

/// The pose of the body in the world, and its velocities in the body's axes. gyro_B [rad/s]: measured at that time. The
/// covariance of the pose about the axes of the world, as ROS wants it; zeros are unknown.
nav_msgs::Odometry odometry_message(const NavState& state, const Eigen::Vector3d& gyro_B,
                                    const std::optional<StateCovariance>& covariance, const FrameNames& frames);
geometry_msgs::PoseWithCovarianceStamped pose_message(const nav_msgs::Odometry& odometry);
geometry_msgs::PoseStamped stamped_pose_message(const nav_msgs::Odometry& odometry);

/// From the world to the body, and on to each camera as calibrated so far.
tf2_msgs::TFMessage transforms_message(const NavState& state, const Rig& rig, const FrameNames& frames);

/// Points with x, y, z in the world, and the id of the corner (its lower 32 bits).
sensor_msgs::PointCloud2 landmarks_message(Timestamp t, std::span<const Landmark> landmarks, const FrameNames& frames);

/// The image (CV_8UC1) with each corner, and where it came from since the image before.
sensor_msgs::Image tracks_message(Timestamp t, const std::string& camera, const cv::Mat& image,
                                  std::span<const Track> tracks);

}  // namespace edged::ros1

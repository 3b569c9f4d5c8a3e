// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The results of the odometry as serialised messages of ROS 1 or ROS 2.
#pragma once

#include <octomap/OcTree.h>

#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "edged/autopilot/vehicle_odometry.hpp"
#include "edged/io/ros/messages/wire.hpp"
#include "edged/occupancy/occupancy_slice.hpp"
#include "edged/rig.hpp"
#include "edged/step.hpp"
#include "node/diagnostics.hpp"
#include "node/node_config.hpp"

namespace edged::node {

// Stamps that ROS cannot hold become its first or last one.

/// What all messages have in common.
struct Format {
  Wire wire = Wire::Cdr;
  FrameNames frames = NodeConfig().frame_names();
};

/// A state as it is published: of a frame on the body, in map or odom (W of its state).
struct Estimate {
  NavState state;
  Eigen::Vector3d gyro_B = Eigen::Vector3d::Zero();  ///< [rad/s], measured at that time
  std::optional<StateCovariance> covariance = {};
  double gyro_sigma = 0.0;  ///< [rad/s] of gyro_B; 0: unknown
};

/// The estimate of another frame on the body, which moves with it. T_B_C: pose of that frame on the body.
Estimate at(const SE3& T_B_C, const Estimate& of_body);
/// The estimate as seen from another frame of the world. T_V_W: pose of the present one in that.
Estimate in(const SE3& T_V_W, const Estimate& in_W);

/// nav_msgs/Odometry: the pose of the base in odom, and its velocities in the base's axes. The covariance of the pose
/// is about the axes of odom, as ROS wants it; zeros are unknown.
std::string odometry_message(const Format& format, const Estimate& estimate);
/// geometry_msgs/PoseWithCovarianceStamped: pose and covariance as in odometry_message, but in the map.
std::string pose_message(const Format& format, const Estimate& estimate);
/// nav_msgs/Path, in the map.
std::string path_message(const Format& format, Timestamp t, const std::deque<StampedPose>& poses);

struct FrameTransform {
  std::string parent, child;
  SE3 T_parent_child;
};
/// tf2_msgs/TFMessage.
std::string transforms_message(Wire wire, Timestamp t, std::span<const FrameTransform> transforms);

/// sensor_msgs/PointCloud2: points with x, y, z in the map, and the id of the feature (its lower 32 bits).
std::string landmarks_message(const Format& format, Timestamp t, std::span<const Landmark> landmarks);

/// nav_msgs/OccupancyGrid: a slice whose cells have edges of voxel_m, at height 0.
std::string occupancy_message(const Format& format, Timestamp t, const OccupancySlice& slice, double voxel_m);

/// octomap_msgs/Octomap: each voxel occupied or free, by what is more likely, in the binary form of OctoMap. Inner
/// nodes of the tree must be updated.
std::string octomap_message(const Format& format, Timestamp t, const octomap::OcTree& tree);

/// sensor_msgs/Image (bgr8): the image (CV_8UC1) with each feature, and where it came from since the image before.
std::string tracks_message(const Format& format, Timestamp t, const CameraStep& camera);

/// px4_msgs/VehicleOdometry of ROS 2.
std::string vehicle_odometry_message(const VehicleOdometry& odometry);

/// diagnostic_msgs/DiagnosticArray with one status. hardware: the rig's name.
std::string diagnostics_message(Wire wire, Timestamp t, const std::string& hardware, const Diagnosis& diagnosis);

}  // namespace edged::node

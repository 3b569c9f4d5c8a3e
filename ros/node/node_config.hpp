// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// The configuration of the node.
#pragma once

#include <string>

#include "edged/autopilot/autopilot_config.hpp"
#include "edged/io/calibration_data.hpp"
#include "edged/options.hpp"
#include "edged/pipeline/input/sequencer.hpp"

namespace edged::node {

/// Names of the frames in tf, as of REP 105.
struct FrameNames {
  std::string map = "map";    ///< W: the map corrects poses in it, which jump then
  std::string odom = "odom";  ///< poses in it are continuous
  std::string base;           ///< of the robot; "" if it is the body
  std::string body = "body";  ///< B, the IMU
  std::string prefix = {};    ///< of cameras, whose names are those of the rig
};

/// The occupancy map that is published as a grid seen from above.
struct OccupancyGridConfig {
  double voxel_m = 0.0;              ///< edge of its voxels; 0: none is made
  double period_s = 5.0;             ///< between messages
  double low_m = 0.0, high_m = 0.0;  ///< what it shows: heights in the map; both 0: those of the path, and a voxel

  void visit(ConfigFields& fields);
};

struct NodeConfig {
  std::string rig;
  std::string imu_time_offset;  ///< seconds to add to the stamps of the IMU, or "auto"; "": its clock is the others'
  Mode mode = Mode::Fused;
  std::string map_file;  ///< written by `edged run --save-map`, to relocalize in; "": none
  FrameNames frames;
  std::string body_pose;  ///< in the base: x y z [m] roll pitch yaw [rad]; "" if /tf_static has it
  bool publish_tf = true;
  SensorDelays delays;
  double max_age_s = 0.25;  ///< QueueConfig::max_age_s
  double path_step_s = 0.1;
  OccupancyGridConfig occupancy;
  std::string mavlink;       ///< URL of an autopilot, as of `edged run --mavlink`; "" without one
  bool publish_px4 = false;  ///< ROS 2: px4_msgs/VehicleOdometry
  AutopilotConfig autopilot;
  OdometryConfig options;

  /// All but `options`, which have another place in ROS 1 than in ROS 2.
  void visit_node(ConfigFields& fields);
  /// All with their prefix, that of the base set.
  FrameNames frame_names() const;
};

/// The calibration of config.rig. Throws InputError if it lacks the poses of the cameras.
Calibration load_node_rig(const NodeConfig& config);

}  // namespace edged::node

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "node/node_config.hpp"

#include "edged/core/check.hpp"
#include "edged/io/calibration.hpp"

namespace edged::node {

void OccupancyGridConfig::visit(ConfigFields& fields) {
  fields.add("voxel_m", voxel_m, {"m", 0, 10, "edge of the voxels of the occupancy map that is published; 0: none"});
  fields.add("period_s", period_s, {"s", 0.1, 3600, "between occupancy maps"});
  fields.add("low_m", low_m,
             {"m", -1e4, 1e4, "heights that the grid shows, from this one on; both 0: those of the path, and a voxel"});
  fields.add("high_m", high_m, {"m", -1e4, 1e4, "up to this one"});
}

void NodeConfig::visit_node(ConfigFields& fields) {
  fields.add("rig", rig, {"", 0, 0, "name of a rig that ships, or a calibration file"});
  fields.choice("mode", mode, {{"events", Mode::Events}, {"frames", Mode::Frames}, {"fused", Mode::Fused}},
                {"", 0, 0, "which cameras beside the IMU"});
  fields.add("imu_time_offset", imu_time_offset,
             {"", 0, 0, "seconds to add to the stamps of an IMU with an epoch of its own, or auto: found by rotation"});
  fields.add("map_file", map_file,
             {"", 0, 0, "map of `edged run --save-map`, to relocalize in; option map.localize_only: only that"});
  fields.add("map_frame", frames.map, {"", 0, 0, "name of the map in tf and headers; corrections move odom in it"});
  fields.add("odom_frame", frames.odom, {"", 0, 0, "name of the frame in which poses are continuous"});
  fields.add("base_frame", frames.base,
             {"", 0, 0, "name of the robot's base, e.g. base_link, whose poses are published; empty: the body's"});
  fields.add("body_frame", frames.body,
             {"", 0, 0, "name of the body, which is the IMU; cameras have those of the rig"});
  fields.add(
      "body_pose", body_pose,
      {"", 0, 0, "pose of the IMU in base_frame, 'x y z roll pitch yaw' in m and rad; empty: that of /tf_static"});
  fields.add("frame_prefix", frames.prefix, {"", 0, 0, "put in front of all names of frames, e.g. drone1/"});
  fields.add("publish_tf", publish_tf, {"", 0, 0, "send transforms of odom, base and cameras"});
  fields.add("delays.events_s", delays.events_s, {"s", 0, 10, "events may lag this far behind the other sensors"});
  fields.add("delays.frames_s", delays.frames_s, {"s", 0, 10, "as delays.events_s"});
  fields.add("delays.imu_s", delays.imu_s, {"s", 0, 10, "as delays.events_s"});
  fields.add("delays.external_s", delays.external_s,
             {"s", 0, 10, "height and velocity samples may lag this far behind the other sensors"});
  fields.add(
      "max_age_s", max_age_s,
      {"s", 0.05, 3600,
       "events that wait longer for the odometry are dropped; frames at twice that. From 8 % of it on events are "
       "thinned, evenly over the image."});
  fields.add("path_step_s", path_step_s, {"s", 0.001, 3600, "between poses of the path"});
  fields.group("occupancy", occupancy);
  fields.add("mavlink", mavlink,
             {"", 0, 0, "send the state to an autopilot: udp:HOST:PORT, udpin:HOST:PORT or serial:DEVICE:BAUD"});
  fields.add("publish_px4", publish_px4,
             {"", 0, 0, "ROS 2: px4_msgs/VehicleOdometry on /fmu/in/vehicle_visual_odometry"});
  fields.group("autopilot", autopilot);
}

FrameNames NodeConfig::frame_names() const {
  FrameNames names = frames;
  if (names.base.empty()) names.base = names.body;
  for (std::string* name : {&names.map, &names.odom, &names.base, &names.body}) name->insert(0, names.prefix);
  return names;
}

Calibration load_node_rig(const NodeConfig& config) {
  Calibration calibration = load_rig(config.rig);
  if (!calibration.has_extrinsics)
    throw InputError::format("rig {} lacks the pose of the camera to the IMU; `edged calib --target` finds it",
                             config.rig);
  return calibration;
}

}  // namespace edged::node

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Reads and writes whole messages in either wire format. All functions that read throw Damage for invalid bytes.
#pragma once

#include <string_view>
#include <vector>

#include "edged/io/ros/messages/wire.hpp"
#include "edged/measurement.hpp"
#include "edged/rig.hpp"
#include "edged/state.hpp"

namespace edged {

/// dvs_msgs, prophesee_event_msgs or dv_ros_msgs EventArray.
struct EventArray {
  std::uint32_t width = 0, height = 0;
  std::vector<Event> events;
};
EventArray read_event_array(WireReader message);
/// events: not empty. The stamp is that of the first event.
std::string event_array_message(Wire wire, const EventBatch& batch, cv::Size sensor);

/// event_camera_msgs/EventPacket: events in the encoding of the sensor.
struct EventPacket {
  Timestamp stamp;
  std::uint32_t width = 0, height = 0;
  std::uint64_t sequence = 0;   ///< counts packets
  std::uint64_t time_base = 0;  ///< [ns], for some encodings
  std::string_view encoding;
  ByteSpan events;
};
EventPacket read_event_packet(WireReader message);
std::string event_packet_message(Wire wire, const EventPacket& packet, std::string_view camera);

/// sensor_msgs/Imu, whose driver may leave out what it does not measure.
struct ImuMessage {
  Timestamp t;
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
  /// Neither marked as not measured (a covariance of -1), nor all zero, nor without a number.
  bool has_gyro = false, has_accel = false;
};
ImuMessage read_imu_message(WireReader message);
ImuSample read_imu(WireReader message);
std::string imu_message(Wire wire, const ImuSample& sample);

/// sensor_msgs/CameraInfo. Throws Damage also if the camera is not calibrated or its distortion is not supported.
CameraModel read_camera_info(WireReader message);
std::string camera_info_message(Wire wire, Timestamp stamp, std::string_view camera, const CameraModel& model);

/// An image of any encoding of 8 or 16 bits, as grey.
struct GrayImage {
  Timestamp t;
  cv::Mat image;  ///< CV_8UC1
};
GrayImage read_image(WireReader message);
GrayImage read_compressed_image(WireReader message);
/// An image by the type of its message, which has the role Frames.
GrayImage read_frame(std::string_view type, WireReader message);
/// sensor_msgs/Image of 8 bit.
std::string image_message(Wire wire, const Frame& frame);

/// An external sample by the type of the message: FluidPressure (by the standard atmosphere), Range (downwards) or any
/// twist.
ExternalSample read_external(std::string_view type, WireReader message);
/// The type of the messages that are written for a sensor of external_sensors(): sensor_msgs/FluidPressure for a
/// height, geometry_msgs/TwistWithCovarianceStamped for a velocity.
std::string_view external_type(std::size_t place);
/// The message of that type, which read_external() reads back.
std::string external_message(Wire wire, const ExternalSample& sample);

/// The pose of a TransformStamped, Odometry or PoseStamped.
struct NamedPose {
  StampedPose pose;
  std::string_view frame;  ///< whose pose it is; "" of a PoseStamped, which does not name it
};
NamedPose read_pose(std::string_view type, WireReader message);
/// geometry_msgs/TransformStamped from frame `child` to "world".
std::string transform_message(Wire wire, const StampedPose& pose, std::string_view child);

}  // namespace edged

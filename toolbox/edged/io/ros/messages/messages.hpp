// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Parses messages of either wire format. All functions throw Damage for invalid bytes.
#pragma once

#include <string_view>
#include <vector>

#include "edged/io/ros/bag/message_source.hpp"
#include "edged/measurement.hpp"
#include "edged/rig.hpp"
#include "edged/state.hpp"

namespace edged {

/// Fields in the order of the message's definition. ROS 1 packs them; CDR begins with four bytes that name its kind and
/// aligns each number to its own size, counted from behind them.
class WireReader {
 public:
  WireReader(Wire wire, ByteSpan message);

  template <typename T>
  T number() {
    if (wire_ == Wire::Cdr) reader_.take((sizeof(T) - reader_.at() % sizeof(T)) % sizeof(T));
    return reader_.number<T>();
  }
  template <int N>
  Eigen::Matrix<double, N, 1> vector() {
    Eigen::Matrix<double, N, 1> v;
    for (double& x : v) x = number<double>();
    return v;
  }
  std::string_view text();
  ByteSpan bytes();
  Timestamp time();
  /// The stamp of a std_msgs/Header.
  Timestamp header();
  /// Length of a list whose items have at least that many bytes.
  std::uint32_t list(std::size_t item_bytes);

 private:
  Wire wire_;
  ByteReader reader_;
};

/// dvs_msgs, prophesee_event_msgs or dv_ros_msgs EventArray.
struct EventArray {
  std::uint32_t width = 0, height = 0;
  std::vector<Event> events;
};
EventArray read_event_array(WireReader message);

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

/// sensor_msgs/Imu, whose driver may leave out what it does not measure.
struct ImuMessage {
  Timestamp t;
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
  /// Neither marked as not measured (a covariance of -1), nor all zero, nor without a number.
  bool has_gyro = false, has_accel = false;
};
ImuMessage read_imu_message(WireReader message);
ImuSample read_imu(WireReader message);

/// sensor_msgs/CameraInfo. Throws Damage also if the camera is not calibrated or its distortion is not supported.
CameraModel read_camera_info(WireReader message);

/// An image of any encoding of 8 or 16 bits, as grey.
struct GrayImage {
  Timestamp t;
  cv::Mat image;  ///< CV_8UC1
};
GrayImage read_image(WireReader message);
GrayImage read_compressed_image(WireReader message);

/// An external sample by the type of the message: FluidPressure (by the standard atmosphere), Range (downwards) or any
/// twist.
ExternalSample read_external(std::string_view type, WireReader message);

/// The reverse of the standard atmosphere. variance_pa2: 0 where the height has no sigma.
struct AirPressure {
  double pressure_pa, variance_pa2;
};
AirPressure pressure_of_height(const HeightSample& height);

StampedPose read_pose_stamped(WireReader message);
/// The pose of TransformStamped and Odometry, which name its frame.
struct NamedPose {
  StampedPose pose;
  std::string_view frame;
};
NamedPose read_named_pose(WireReader message);

}  // namespace edged

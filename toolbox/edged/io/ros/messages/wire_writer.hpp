// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Writes messages in either wire format: the counterpart of messages.hpp.
#pragma once

#include <span>
#include <string_view>

#include "edged/io/ros/bag/message_source.hpp"
#include "edged/io/ros/messages/messages.hpp"
#include "edged/measurement.hpp"
#include "edged/rig.hpp"
#include "edged/state.hpp"

namespace edged {

/// Writes the fields in the order of the definition of the message; see WireReader.
class WireWriter {
 public:
  explicit WireWriter(Wire wire);

  template <typename T>
  void number(T value) {
    if (wire_ == Wire::Cdr) out_.append((sizeof(T) - (out_.size() - kKindBytes) % sizeof(T)) % sizeof(T), '\0');
    append_number(out_, value);
  }
  void numbers(std::span<const double> values);
  void text(std::string_view value);
  void bytes(ByteSpan value);
  /// t: from zero to latest_stamp().
  void time(Timestamp t);
  void header(Timestamp stamp, std::string_view frame_id);

  const std::string& message() const { return out_; }

 private:
  static constexpr std::size_t kKindBytes = 4;
  Wire wire_;
  std::string out_;
};

/// The latest stamp that the format holds. The earliest is zero.
Timestamp latest_stamp(Wire wire);

/// dvs_msgs/EventArray, prophesee_event_msgs/EventArray and dv_ros_msgs/EventArray; events must not be empty, and the
/// stamp is that of the first event.
std::string event_array_message(Wire wire, const EventBatch& batch, cv::Size sensor);
/// event_camera_msgs/EventPacket of a camera.
std::string event_packet_message(Wire wire, const EventPacket& packet, std::string_view camera);
/// sensor_msgs/Image of 8 bit.
std::string image_message(Wire wire, const Frame& frame);
/// sensor_msgs/Imu.
std::string imu_message(Wire wire, const ImuSample& sample);
/// The message that read_external() reads back: sensor_msgs/FluidPressure for a height,
/// geometry_msgs/TwistWithCovarianceStamped for a velocity.
std::string external_message(Wire wire, const ExternalSample& sample);
/// geometry_msgs/TransformStamped from frame `child` to "world".
std::string transform_message(Wire wire, const StampedPose& pose, std::string_view child);
/// sensor_msgs/CameraInfo.
std::string camera_info_message(Wire wire, Timestamp stamp, std::string_view camera, const CameraModel& model);

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
#include "edged/io/ros/messages/sensor_messages.hpp"

namespace edged {

EventArray EventMessageDecoder::decode(std::string_view type, WireReader message) {
  constexpr std::uint32_t kMostSide = 16384;  // the limit of --geometry
  EventArray array;
  if (type == "event_camera_msgs/EventPacket" || type == "event_array_msgs/EventArray") {
    const EventPacket packet = read_event_packet(message);
    array = {packet.width, packet.height, packets_.decode(packet)};
  } else {
    array = read_event_array(message);
  }
  if (array.width > kMostSide || array.height > kMostSide) throw Damage("a sensor of that size");
  return array;
}

GrayImage read_frame(std::string_view type, WireReader message) {
  return type == "sensor_msgs/Image" ? read_image(message) : read_compressed_image(message);
}

}  // namespace edged

// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Any bytes as a ROS message: the first byte chooses the wire format and the type.
#include <array>

#include "edged/io/ros/messages/event_packets.hpp"
#include "edged/io/ros/messages/messages.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace edged;
  using Read = void (*)(const WireReader&);
  constexpr std::array<Read, 8> kReaders = {
      [](const WireReader& m) { read_event_array(m); },
      [](const WireReader& m) {
        EventMessageDecoder decoder;
        const EventPacket packet = read_event_packet(m);
        decoder.decode(packet);
        decoder.decode(packet);  // as the one that follows
      },
      [](const WireReader& m) { read_imu(m); },
      [](const WireReader& m) { read_camera_info(m); },
      [](const WireReader& m) { read_image(m); },
      [](const WireReader& m) { read_compressed_image(m); },
      [](const WireReader& m) { read_pose("geometry_msgs/PoseStamped", m); },
      [](const WireReader& m) { read_pose("nav_msgs/Odometry", m); },
  };
  if (size == 0) return 0;
  try {
    kReaders[data[0] / 2 % kReaders.size()](
        WireReader(data[0] % 2 == 0 ? Wire::Ros1 : Wire::Cdr, {data + 1, size - 1}));
  } catch (const Damage&) {
    return 0;
  }
  return 0;
}

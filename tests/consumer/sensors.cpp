// SPDX-FileCopyrightText: 2026 Edged USLAM developers
// SPDX-License-Identifier: Apache-2.0
// Measurements from the user's own drivers, here an IMU at rest and an event camera that sees little.
#include <cstdio>

#include "edged/pipeline/odometry.hpp"

int main() {
  const edged::CameraModel lens(240, 180, 200, 200, 120, 90, edged::DistortionModel::None);
  edged::Rig rig{"mine", {{"events", edged::Modality::Events, lens, edged::SE3(), edged::Duration(0)}}};
  const edged::OdometryConfig config;
  edged::Packetizer packetizer(rig, edged::Mode::Events, config.packets);
  edged::Odometry odometry(rig, edged::ImuNoise{}, edged::Mode::Events, config);

  int packets = 0;
  for (int ms = 0; ms < 500; ms += 5) {
    const edged::Timestamp t = edged::timestamp_from_seconds(1e-3 * ms);
    packetizer.add(edged::ImuSample{t, {0, 0, 0}, {0, 0, 9.81}});
    packetizer.add(edged::EventBatch{"events", {{t, 100, 80, true}}});
    while (const std::optional<edged::Packet> packet = packetizer.next()) {
      const edged::OdometryOutput output = odometry.process(*packet);
      ++packets;
      if (packets == 1) std::printf("waiting for: %s\n", output.waiting_for.c_str());
    }
  }
  std::printf("%d packets\n", packets);
  return packets > 5 ? 0 : 1;
}
